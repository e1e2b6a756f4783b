//! The page around its sections: head, style, data, scripts. Nothing in it is fetched from anywhere.
//!
//! The policy in the head forbids every connection, so that even a fault in the escaping could send nothing away.

use std::io::Write;

use super::html::{embedded, text};
use super::provenance::Provenance;
use crate::io::{DOCUMENT_TAG, END_TAG, TABLE_TAG};

/// Where a browser may load from: nowhere; what stands in the page itself may run, and pictures stand in it as data.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; \
     base-uri 'none'; form-action 'none'";

const STYLES: [&str; 2] = [include_str!("assets/page.css"), include_str!("assets/charts.css")];
/// three.js, of which `assets/vendor/build.sh` keeps what a page draws with.
const THREE: &str = include_str!("assets/vendor/three.min.js");
const THREE_LICENCE: &str = include_str!("assets/vendor/three.LICENSE");
/// Our own scripts, in the order in which they build on each other.
const SCRIPTS: [&str; 10] = [
    include_str!("assets/tooltip.js"),
    include_str!("assets/data.js"),
    include_str!("assets/colours.js"),
    include_str!("assets/shapes.js"),
    include_str!("assets/body.js"),
    include_str!("assets/lively.js"),
    include_str!("assets/stage.js"),
    include_str!("assets/controls.js"),
    include_str!("assets/maps.js"),
    include_str!("assets/main.js"),
];

/// What stands on a page.
#[derive(Clone, Debug, Default)]
pub(super) struct Page<'a> {
    /// Small words above the title: what kind of page it is.
    pub kind: &'a str,
    /// What it is about.
    pub title: String,
    /// The finding in one or two sentences of HTML.
    pub lead: String,
    /// What must be read before anything else: that a run was interrupted, that parts failed.
    pub notices: Vec<String>,
    /// Sections of HTML.
    pub sections: String,
    /// The document, as `--json` prints it.
    pub document: &'a [u8],
    /// The table for people.
    pub table: &'a [u8],
    /// Data of the turning view, where there is one.
    pub view: Option<String>,
}

impl Page<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// What the system says.
    pub(super) fn write(&self, provenance: &Provenance, out: &mut dyn Write) -> std::io::Result<()> {
        let (title, version) = (text(&self.title), env!("CARGO_PKG_VERSION"));
        // what stands below the turning view waits for its buttons, lest it move when they come
        let waits = if self.view.is_some() { " class=\"waiting\"" } else { "" };
        write!(
            out,
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"generator\" content=\"palpate {version}\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n\
             <title>{title} - palpate</title>\n<style>\n{}</style>\n\
             <noscript><style>.waiting #space ~ *, .waiting footer {{ display: revert; }}</style></noscript>\n\
             </head>\n<body{waits}>\n\
             <header><p class=\"kind\">{}</p><h1>{title}</h1></header>\n<main>\n",
            STYLES.concat(),
            text(self.kind)
        )?;
        for notice in &self.notices {
            writeln!(out, "<p class=\"notice\" role=\"status\">{}</p>", text(notice))?;
        }
        writeln!(out, "<p class=\"lead\">{}</p>", self.lead)?;
        out.write_all(self.sections.as_bytes())?;
        out.write_all(provenance.section().as_bytes())?;
        let table = String::from_utf8_lossy(self.table);
        let document = String::from_utf8_lossy(self.document);
        let quoted = serde_json::to_string(&*table).map_err(std::io::Error::from)?;
        write!(
            out,
            "<section><details><summary>The same as text</summary><pre>{}</pre></details></section>\n\
             </main>\n<footer>palpate {version}</footer>\n\
             {DOCUMENT_TAG}\n{}{END_TAG}\n{TABLE_TAG}{}{END_TAG}\n",
            text(&table),
            embedded(&document),
            embedded(&quoted)
        )?;
        self.write_scripts(out)?;
        out.write_all(b"</body>\n</html>\n")
    }

    /// The data and the scripts; the library for drawing in space only where there is something in space.
    fn write_scripts(&self, out: &mut dyn Write) -> std::io::Result<()> {
        if let Some(view) = &self.view {
            writeln!(out, "<script type=\"application/json\" id=\"palpate-view\">{}</script>", embedded(view))?;
            // as text, which `main.js` runs once the first picture is seen; its licence asks to stand in every copy
            writeln!(
                out,
                "<script type=\"text/plain\" id=\"palpate-library\">\n{THREE}\n/*\n{THREE_LICENCE}*/\n</script>"
            )?;
        }
        writeln!(out, "<script>\n\"use strict\";\n{}</script>", SCRIPTS.concat())
    }
}
