//! The document that a page (`report.html`) holds, out and back to the same bytes.
//!
//! ```text
//! <script type="application/json" id="palpate-document"> JSON, with & < > U+2028 U+2029 as \uXXXX </script>
//! ```
//!
//! Names in a page are escaped, so the first such tag is the page's own.

use std::borrow::Cow;

use super::IoError;

/// Opens the document that the page is about.
pub(crate) const DOCUMENT_TAG: &str = "<script type=\"application/json\" id=\"palpate-document\">";
/// Opens the table for people, a string of JSON.
pub(crate) const TABLE_TAG: &str = "<script type=\"application/json\" id=\"palpate-table\">";
/// Ends either.
pub(crate) const END_TAG: &str = "</script>";

/// What a page holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PageContent {
    /// The document, as `--json` printed it.
    pub document: Vec<u8>,
    /// The table that the verb printed.
    pub table: String,
}

/// Whether these bytes are a page and no JSON.
fn is_page(bytes: &[u8]) -> bool {
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    start.first() == Some(&b'<')
}

/// The content of a page; `None` of bytes that are no page.
///
/// # Errors
/// [`IoError::Surface`] where the page is not one of palpate's, or was cut off.
pub(crate) fn page_content(file: &str, bytes: &[u8]) -> Result<Option<PageContent>, IoError> {
    if !is_page(bytes) {
        return Ok(None);
    }
    let wrong = |what: &str| IoError::Surface { file: file.into(), what: what.into() };
    let text = std::str::from_utf8(bytes).map_err(|_| wrong("a page that is no UTF-8 text"))?;
    let part = |tag: &str| text.split_once(tag).map(|(_, rest)| rest.split_once(END_TAG).map(|(part, _)| part));
    let document = part(DOCUMENT_TAG)
        .ok_or_else(|| wrong("a page without a document; palpate reads the report.html that it wrote itself"))?
        .ok_or_else(|| wrong("a page that ends within its document"))?;
    let table = part(TABLE_TAG).flatten().and_then(|json| serde_json::from_str::<String>(json.trim()).ok());
    Ok(Some(PageContent { document: plain(document.trim_start()).into_bytes(), table: table.unwrap_or_default() }))
}

/// The bytes of a saved document, whether they stand alone or in a page.
///
/// # Errors
/// Those of [`page_content`].
pub(crate) fn document_bytes<'a>(file: &str, bytes: &'a [u8]) -> Result<Cow<'a, [u8]>, IoError> {
    Ok(page_content(file, bytes)?.map_or(Cow::Borrowed(bytes), |page| Cow::Owned(page.document)))
}

/// The schema of a document, where it says one.
pub(crate) fn schema_of(document: &[u8]) -> Option<String> {
    #[derive(serde::Deserialize)]
    struct Head {
        schema: String,
    }
    serde_json::from_slice::<Head>(document).ok().map(|head| head.schema)
}

/// The text with the five escapes of a page undone. A backslash that is itself escaped begins none.
fn plain(json: &str) -> String {
    let mut out = String::with_capacity(json.len());
    let mut rest = json;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        let (character, length) = match rest.as_bytes().get(at + 1..at + 6) {
            Some(b"u003c") => ('<', 6),
            Some(b"u003e") => ('>', 6),
            Some(b"u0026") => ('&', 6),
            Some(b"u2028") => ('\u{2028}', 6),
            Some(b"u2029") => ('\u{2029}', 6),
            _ => {
                // the backslash and what it escapes
                let end = rest[at + 1..].chars().next().map_or(at + 1, |c| at + 1 + c.len_utf8());
                out.push_str(&rest[at..end]);
                rest = &rest[end..];
                continue;
            }
        };
        out.push(character);
        rest = &rest[at + length..];
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(document: &str) -> String {
        format!("<!doctype html>\n{DOCUMENT_TAG}{document}{END_TAG}{TABLE_TAG}\"a\\nb\"{END_TAG}")
    }

    #[test]
    fn escapes_are_undone_and_no_others() {
        let found = page_content("r.html", page("{\"a\":\"\\u003cb\\u003e \\\\u003c \\u2028\\n\"}").as_bytes());
        let found = found.unwrap().unwrap();
        assert_eq!(String::from_utf8(found.document).unwrap(), "{\"a\":\"<b> \\\\u003c \u{2028}\\n\"}");
        assert_eq!(found.table, "a\nb");
        assert_eq!(plain("\\"), "\\");
    }

    #[test]
    fn other_pages_and_halves_are_refused_and_json_is_left_alone() {
        assert_eq!(page_content("s.json", b" {\"schema\":1}").unwrap(), None);
        let foreign = page_content("p.html", b"<html></html>").unwrap_err().to_string();
        assert!(foreign.starts_with("p.html") && foreign.contains("report.html"), "{foreign}");
        let half = page("{\"a\":1}");
        let cut = page_content("p.html", half.split("}").next().unwrap().as_bytes()).unwrap_err().to_string();
        assert!(cut.contains("ends within"), "{cut}");
        assert_eq!(schema_of(b"{\"schema\":\"palpate.study/1\",\"x\":2}").as_deref(), Some("palpate.study/1"));
    }
}
