//! The page of one surface: of `run`, `fit` and `show`.

use std::io::Write;

use super::html::{heading, short, text};
use super::provenance::Provenance;
use super::shell::Page;
use super::surface_sections::{cards, fields, maps, numbers, residuals, stage, trust};
use super::view_data::view_data;
use super::words::finding;
use crate::report::description::{Description, INVERSE_CRIME, shown_view};
use crate::report::document::FitDocument;
use crate::report::fold::PAGE_WIDTH;
use crate::report::json::write_json;
use crate::report::table::write_table;
use crate::report::words::{Audience, write_words};

/// Sections of a surface, and the data of its turning view.
///
/// # Errors
/// What the system says of memory.
pub(super) fn surface(description: &Description) -> std::io::Result<(String, String)> {
    let (view, document) = (shown_view(description), description.document());
    let fields = fields(&view, document);
    let mut sections = cards(document);
    sections.push_str(&stage(&view, &fields));
    sections.push_str(&maps(&view, &fields, document)?);
    sections.push_str(&numbers(document));
    if let Some(contacts) = &view.contacts {
        sections.push_str(&residuals(document, contacts));
    }
    sections.push_str(&trust(document));
    Ok((sections, view_data(&view, &fields, document.unit.as_deref())))
}

/// Writes the page of a surface; `saved` is its document as it is saved, `name` the scene or the file.
///
/// # Errors
/// What the system says.
pub(crate) fn write_fit_page(
    description: &Description,
    saved: &FitDocument,
    name: &str,
    provenance: &Provenance,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let document = description.document();
    let (mut json, mut table) = (Vec::new(), Vec::new());
    write_json(saved, &mut json)?;
    write_words(name, document, Audience::READER, &mut table)?;
    table.push(b'\n');
    write_table(document, PAGE_WIDTH, &mut table)?;
    let (sections, view) = surface(description)?;
    // a scene has a name, a file a path
    let title = if provenance.scene.is_some() { short(name) } else { heading(name) };
    let kind = if provenance.scene.is_some() { "a scene, swept and fitted" } else { "a surface from contacts" };
    let page = Page {
        kind,
        lead: text(&finding(document)),
        notices: document.fit.notes.iter().filter(|note| note.starts_with(INVERSE_CRIME)).cloned().collect(),
        title,
        sections,
        document: &json,
        table: &table,
        view: Some(view),
    };
    page.write(provenance, out)
}
