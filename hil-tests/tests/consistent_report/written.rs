//! What `identify --out` writes, read back: the page as text and tables, the model, the JSON form.

use std::path::Path;

use serde_json::Value;

/// A table of the page; the first row is its head.
pub(crate) type Table = Vec<Vec<String>>;

/// The files of a result.
pub(crate) struct Written {
    /// Tables of `report.html`.
    pub tables: Vec<Table>,
    /// Paragraphs of `report.html`.
    pub paragraphs: Vec<String>,
    /// `model.toml`.
    pub model: toml::Table,
    /// `identification.json`.
    pub json: Value,
}

impl Written {
    /// Reads the files of a folder.
    pub(crate) fn read(folder: &Path) -> Self {
        let text = |name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
        let page = text("report.html");
        let tables = between(&page, "<table>", "</table>").into_iter();
        Self {
            tables: tables.map(|table| rows(&table)).collect(),
            paragraphs: between(&page, "<p", "</p>")
                .iter()
                .map(|p| plain(p))
                .collect(),
            model: text("model.toml").parse().unwrap(),
            json: serde_json::from_str(&text("identification.json")).unwrap(),
        }
    }

    /// The table whose head begins with a cell.
    pub(crate) fn table(&self, first: &str) -> Option<&Table> {
        self.tables.iter().find(|table| table[0][0] == first)
    }

    /// Parameters of `model.toml`.
    pub(crate) fn identified(&self) -> &toml::Table {
        let axis = self.model.get("axis").and_then(|axes| axes.get(0));
        let identified = axis.unwrap_or_else(|| &self.model["identified"]);
        let own = identified.get("identified").unwrap_or(identified);
        own.as_table().unwrap()
    }
}

fn rows(table: &str) -> Table {
    let cells = |row: &String| {
        let row = row.replace("<th>", "<td>").replace("</th>", "</td>");
        let cells = between(&row, "<td>", "</td>");
        cells.iter().map(|cell| plain(cell)).collect()
    };
    between(table, "<tr", "</tr>").iter().map(cells).collect()
}

/// Every stretch of a text between two marks.
fn between(text: &str, from: &str, to: &str) -> Vec<String> {
    let pieces = text.split(from).skip(1);
    let inside = pieces.filter_map(|piece| piece.split_once(to));
    inside.map(|(inside, _)| inside.to_owned()).collect()
}

/// Text without tags.
fn plain(html: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for letter in html
        .trim_start_matches(" class=\"key\"")
        .trim_start_matches('>')
        .chars()
    {
        match letter {
            '<' => inside = true,
            '>' => inside = false,
            letter if !inside => text.push(letter),
            _ => {}
        }
    }
    text.replace("&lt;", "<")
        .replace("&gt;", ">")
        .replace("&amp;", "&")
}
