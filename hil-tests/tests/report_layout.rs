//! The report of the reference machine in a browser: nothing lies over anything else, at any width,
//! on black and on paper.
//!
//! Needs Chromium, so the tests are ignored by `cargo test`; `.ci/run` installs it and runs
//! `cargo test -p hil-tests --test report_layout -- --ignored`.

use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use plant_sim::Machine;
use tempfile::TempDir;
use workbench::commands::commission::{self, Wanted};
use workbench::interrupt::Interrupt;
use workbench::network::place::Place;

const CHECK: &str = include_str!("report_layout/check.js");
/// What a report of two axes may weigh, on a screen and printed, bytes.
const HEAVIEST: u64 = 1_500_000;
/// Pages of the same.
const MOST_PAGES: usize = 8;

/// The report of the reference machine, with a tolerance on it, and a folder for pages.
fn report() -> (TempDir, &'static str) {
    static REPORT: OnceLock<String> = OnceLock::new();
    let page = REPORT.get_or_init(commissioned);
    (tempfile::tempdir().unwrap(), page)
}

fn commissioned() -> String {
    let folder = tempfile::tempdir().unwrap();
    let wanted = Wanted {
        tolerance_um: Some(5.0),
        ..Wanted::into(folder.path())
    };
    let machine = Machine::reference();
    commission::commission(&machine, Place::InProcess, &wanted, &Interrupt::never()).unwrap();
    std::fs::read_to_string(folder.path().join("report.html")).unwrap()
}

fn chromium(arguments: &[String]) -> Vec<u8> {
    let common = ["--headless", "--no-sandbox", "--disable-gpu"];
    let output = Command::new("chromium")
        .args(common)
        .args(arguments)
        .output()
        .expect("chromium is installed: apt-get install chromium");
    assert!(output.status.success(), "{output:?}");
    output.stdout
}

/// How a page is looked at.
struct View {
    width_px: u32,
    is_dark: bool,
    /// Laid out as on paper, on a screen as wide as that.
    is_paper: bool,
}

/// What is there, and what is wrong with it.
fn looked_at(folder: &Path, page: &str, view: &View) -> (String, Vec<String>) {
    let paper = if view.is_paper {
        "window.isPaper=true;"
    } else {
        ""
    };
    let mut page = page.replace(
        "</body>",
        &format!("<script>{paper}{CHECK}</script></body>"),
    );
    if view.is_paper {
        page = page.replace("@media print{", "@media all{");
    }
    let inner = folder.join("inner.html");
    std::fs::write(&inner, page).unwrap();
    let outer = folder.join("outer.html");
    let width = view.width_px;
    // Paper has no bar beside it.
    let scrolling = if view.is_paper { "no" } else { "auto" };
    std::fs::write(
        &outer,
        format!(
            "<!DOCTYPE html><pre id=\"said\"></pre><iframe src=\"inner.html\" scrolling=\"{scrolling}\" style=\"width:{width}px;height:2000px;border:0\"></iframe>\
             <script>addEventListener('message', e => document.getElementById('said').textContent = e.data)</script>"
        ),
    )
    .unwrap();
    let scheme = u8::from(!view.is_dark);
    let said = chromium(&[
        "--virtual-time-budget=20000".into(),
        "--window-size=1400,2200".into(),
        format!("--blink-settings=preferredColorScheme={scheme}"),
        "--dump-dom".into(),
        format!("file://{}", outer.display()),
    ]);
    let said = String::from_utf8(said).unwrap();
    let said = said.split("<pre id=\"said\">").nth(1).unwrap_or_default();
    let mut lines = said
        .split("</pre>")
        .next()
        .unwrap()
        .lines()
        .map(String::from);
    let first = lines.next().unwrap_or_default();
    (first, lines.collect())
}

#[test]
#[ignore = "needs chromium"]
fn nothing_lies_over_anything_else_at_any_width_on_black_and_on_paper() {
    let (folder, page) = report();
    assert!(page.contains("PASS (simulated machine, nothing was measured): circular deviation G"));
    let views = [
        (1280, false, false),
        (420, false, false),
        (1280, true, false),
        // Between the margins of A4 and of Letter.
        (703, false, true),
        (725, false, true),
    ];
    for (width_px, is_dark, is_paper) in views {
        let view = View {
            width_px,
            is_dark,
            is_paper,
        };
        let (seen, wrong) = looked_at(folder.path(), page, &view);
        let scheme = if is_dark { "dark" } else { "light" };
        assert!(
            seen.starts_with("texts ") && seen.ends_with(&format!("{scheme}, {width_px} px")),
            "{seen}"
        );
        assert_eq!(
            wrong,
            Vec::<String>::new(),
            "{width_px} px, {scheme}, paper {is_paper}"
        );
    }
}

/// The look at a page finds what is wrong with one.
#[test]
#[ignore = "needs chromium"]
fn a_page_with_defects_is_found_out() {
    let folder = tempfile::tempdir().unwrap();
    let defects = "<!DOCTYPE html><body style=\"margin:0\"><div style=\"position:absolute\">one</div><div>two</div>\
        <p style=\"color:#ccc\">faint</p><div style=\"width:3000px\">wide</div>\
        <svg width=\"50\" height=\"20\"><rect class=\"ground\" fill=\"#fff\"/><title>t</title><desc></desc><text x=\"40\" y=\"12\">outside</text></svg></body>";
    let view = View {
        width_px: 1280,
        is_dark: false,
        is_paper: false,
    };
    let (_, wrong) = looked_at(folder.path(), defects, &view);
    for defect in [
        "\"one\" and \"two\" lie over each other",
        "\"outside\" leaves its picture",
        "the page is 3000 px wide in 1280 px",
        "\"faint\" has a contrast of 1.6",
        "a picture without words",
    ] {
        assert!(
            wrong.iter().any(|line| line == defect),
            "{defect}: {wrong:#?}"
        );
    }
}

#[test]
#[ignore = "needs chromium"]
fn the_report_fits_on_eight_pages_of_either_paper_and_is_light() {
    let (folder, page) = report();
    assert!((page.len() as u64) < HEAVIEST, "{} bytes", page.len());
    for paper in ["A4", "Letter"] {
        let own = folder.path().join(format!("{paper}.html"));
        std::fs::write(
            &own,
            page.replace("@page{", &format!("@page{{size:{paper};")),
        )
        .unwrap();
        let pdf = folder.path().join(format!("{paper}.pdf"));
        print(&own, &pdf);
        let bytes = std::fs::read(&pdf).unwrap();
        assert!(
            (bytes.len() as u64) < HEAVIEST,
            "{paper}: {} bytes",
            bytes.len()
        );
        let pages = pages(&bytes);
        assert!((2..=MOST_PAGES).contains(&pages), "{paper}: {pages} pages");
    }
}

fn print(page: &Path, pdf: &Path) {
    chromium(&[
        "--no-pdf-header-footer".into(),
        format!("--print-to-pdf={}", pdf.display()),
        format!("file://{}", page.display()),
    ]);
}

/// Pages of a PDF: its page objects are not compressed.
fn pages(pdf: &[u8]) -> usize {
    let text = String::from_utf8_lossy(pdf);
    let objects = text.split("/Type /Page").skip(1);
    objects.filter(|rest| !rest.starts_with('s')).count()
}
