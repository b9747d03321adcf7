//! A self-contained HTML page: no script, no file beside it.

use std::fmt::Write as _;

const STYLE: &str = "body{font:15px/1.5 sans-serif;color:#222;max-width:1100px;margin:2em auto;padding:0 1em}\
h1{font-size:1.7em}h2{margin-top:2em;border-bottom:1px solid #bbb}table{border-collapse:collapse;margin:1em 0}\
td,th{border:1px solid #ccc;padding:.25em .7em;text-align:right}td:first-child,th:first-child{text-align:left}th{background:#f0f0f0}\
.good{background:#e8f5e9}.row{display:flex;flex-wrap:wrap;gap:1em}.row>div{flex:1 1 460px;min-width:0}.key{font-size:1.1em}small{color:#666}\
@media print{body{max-width:none;margin:0}h2{break-after:avoid}svg,table{break-inside:avoid}}";

/// An HTML page in the making.
pub struct Page(String);

impl Page {
    /// A page with a title.
    #[must_use]
    pub fn new(title: &str) -> Self {
        let title = escaped(title);
        Self(format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title><style>{STYLE}</style></head><body>\n<h1>{title}</h1>\n"
        ))
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        self.raw(&format!("<h2>{}</h2>\n", escaped(text)));
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.raw(&format!("<p>{}</p>\n", escaped(text)));
    }

    /// The sentence that matters.
    pub fn key(&mut self, text: &str) {
        self.raw(&format!("<p class=\"key\"><b>{}</b></p>\n", escaped(text)));
    }

    /// A table; the first row is the head. Rows whose first cell starts with `✓` are marked.
    pub fn table(&mut self, rows: &[Vec<String>]) {
        self.raw("<table>\n");
        for (index, row) in rows.iter().enumerate() {
            let tag = if index == 0 { "th" } else { "td" };
            let class = if row.first().is_some_and(|cell| cell.starts_with('✓')) {
                " class=\"good\""
            } else {
                ""
            };
            let cells: String = row.iter().fold(String::new(), |mut cells, cell| {
                let _ = write!(cells, "<{tag}>{}</{tag}>", escaped(cell));
                cells
            });
            self.raw(&format!("<tr{class}>{cells}</tr>\n"));
        }
        self.raw("</table>\n");
    }

    /// Pictures side by side, where the page is wide enough.
    pub fn pictures(&mut self, pictures: &[String]) {
        self.raw("<div class=\"row\">");
        for picture in pictures {
            self.raw(&format!("<div>{picture}</div>"));
        }
        self.raw("</div>\n");
    }

    /// The finished page.
    #[must_use]
    pub fn finish(mut self) -> String {
        self.raw("</body></html>\n");
        self.0
    }

    fn raw(&mut self, text: &str) {
        self.0.push_str(text);
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_break_the_page() {
        let mut page = Page::new("a < b & c");
        page.paragraph("<script>");
        let text = page.finish();
        assert!(text.contains("<h1>a &lt; b &amp; c</h1>"), "{text}");
        assert!(text.contains("<p>&lt;script&gt;</p>"), "{text}");
    }

    #[test]
    fn the_first_row_of_a_table_is_its_head_and_accepted_rows_are_marked() {
        let mut page = Page::new("");
        page.table(
            &[["effect"], ["✓ stribeck"], ["delay"]].map(|row| row.map(String::from).to_vec()),
        );
        let text = page.finish();
        assert!(text.contains("<tr><th>effect</th></tr>"), "{text}");
        assert!(
            text.contains("<tr class=\"good\"><td>✓ stribeck</td></tr>"),
            "{text}"
        );
        assert!(text.contains("<tr><td>delay</td></tr>"), "{text}");
    }
}
