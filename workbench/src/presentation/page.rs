//! A self-contained HTML page: style, pictures and a few lines of script inside, nothing from a
//! network.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::plots;

const STYLE: &str = include_str!("page.css");
/// Wheel and drag on a picture; without it the page is whole all the same.
const SCRIPT: &str = include_str!("zoom.js");

/// What stands across a page about a simulated machine.
pub const SIMULATION: &str = "SIMULATION";

/// An HTML page in the making.
pub struct Page {
    title: String,
    /// What stands at the foot of every printed page.
    foot: String,
    body: String,
}

impl Page {
    /// A page with a title, which stands first on it.
    #[must_use]
    pub fn new(title: &str) -> Self {
        let mut page = Self::untitled(title);
        page.add(&html! { h1 { (title) } });
        page
    }

    /// A page whose title is that of its window alone.
    #[must_use]
    pub fn untitled(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            foot: title.to_owned(),
            body: String::new(),
        }
    }

    /// Puts something else than the title at the foot of every printed page.
    pub fn foot(&mut self, text: &str) {
        text.clone_into(&mut self.foot);
    }

    /// Anything.
    pub fn add(&mut self, markup: &Markup) {
        self.body.push_str(&markup.0);
        self.body.push('\n');
    }

    /// Says in large letters that nothing was measured, here and on every printed page.
    pub fn simulation(&mut self) {
        self.foot = format!("SIMULATION, {}", self.foot);
        self.add(&html! { div.simulation { (SIMULATION) } });
    }

    /// A heading.
    pub fn heading(&mut self, text: &str) {
        self.add(&html! { h2 { (text) } });
    }

    /// A paragraph.
    pub fn paragraph(&mut self, text: &str) {
        self.add(&html! { p { (text) } });
    }

    /// The sentence that matters.
    pub fn key(&mut self, text: &str) {
        self.add(&html! { p.key { b { (text) } } });
    }

    /// A table; the first row is the head. Rows whose first cell starts with `✓` are marked.
    pub fn table(&mut self, rows: &[Vec<String>]) {
        self.add(&table(rows));
    }

    /// A table for whoever wants to know more: folded on a screen, left out on paper.
    pub fn details(&mut self, summary: &str, rows: &[Vec<String>]) {
        self.add(&html! {
            details { summary { (summary) } (table(rows)) }
        });
    }

    /// Pictures side by side, where the page is wide enough.
    pub fn pictures(&mut self, pictures: &[String]) {
        self.add(&html! {
            div.row { @for picture in pictures { figure { (PreEscaped(picture)) } } }
        });
    }

    /// The finished page.
    #[must_use]
    pub fn finish(self) -> String {
        let paper = paper(&self.foot);
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width,initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(STYLE)) (PreEscaped(plots::style())) (PreEscaped(paper)) }
                }
                body {
                    main { (PreEscaped(self.body)) }
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        }
        .into_string()
            + "\n"
    }
}

/// Margins of printed pages, with a foot and the number of the page.
fn paper(foot: &str) -> String {
    // What could end the string, the sheet or the element has no place in it.
    let foot: String = foot
        .chars()
        .map(|letter| {
            if "\\\"<>\n".contains(letter) {
                ' '
            } else {
                letter
            }
        })
        .collect();
    let font = "font:8pt Arial,\"Liberation Sans\",\"DejaVu Sans\",sans-serif";
    format!(
        "@page{{margin:12mm 12mm 14mm;@bottom-left{{content:\"{foot}\";{font}}}@bottom-right{{content:counter(page) \" / \" counter(pages);{font}}}}}"
    )
}

/// A table; the first row is the head. Rows whose first cell starts with `✓` are marked.
#[must_use]
pub fn table(rows: &[Vec<String>]) -> Markup {
    let (head, body) = rows
        .split_first()
        .map_or((&[][..], rows), |(head, body)| (head, body));
    html! {
        div.wide {
            table {
                thead { tr { @for cell in head { th { (cell) } } } }
                tbody {
                    @for row in body {
                        tr class=[row.first().filter(|cell| cell.starts_with('✓')).map(|_| "good")] {
                            @for cell in row { td { (cell) } }
                        }
                    }
                }
            }
        }
    }
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

    #[test]
    fn a_foot_cannot_break_the_style() {
        let mut page = Page::new("");
        page.foot("a \"} </style> b");
        let text = page.finish();
        assert!(text.contains("content:\"a  }  /style  b\""), "{text}");
        assert_eq!(text.matches("</style>").count(), 1);
    }

    #[test]
    fn nothing_comes_from_a_network() {
        let text = Page::new("").finish();
        for reference in ["src=", "href=", "@import", "url("] {
            assert!(!text.contains(reference), "{reference}");
        }
    }
}
