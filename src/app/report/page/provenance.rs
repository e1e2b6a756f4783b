//! Where a page's numbers come from: the command, the scene, the seed, the version.

use std::fmt::Write as _;

use super::html::text;

/// What was asked.
#[derive(Clone, Debug, Default)]
pub(crate) struct Provenance {
    /// The command as it was typed.
    pub command: String,
    /// The scene or the file.
    pub subject: String,
    /// The scene as TOML.
    pub scene: Option<String>,
    /// Its seed.
    pub seed: Option<u64>,
}

impl Provenance {
    /// The section at the page's end.
    pub(super) fn section(&self) -> String {
        let mut rows = format!("<dt>Command</dt><dd><code>{}</code></dd>\n", text(&self.command));
        let subject = if self.seed.is_some() { "Scene" } else { "Input" };
        let _ = writeln!(rows, "<dt>{subject}</dt><dd><code>{}</code></dd>", text(&self.subject));
        if let Some(seed) = self.seed {
            let _ = writeln!(rows, "<dt>Seed</dt><dd><code>{seed}</code></dd>");
        }
        let _ = writeln!(rows, "<dt>Version</dt><dd>palpate {}</dd>", env!("CARGO_PKG_VERSION"));
        let scene = self.scene.as_ref().map_or(String::new(), |scene| {
            format!("<details><summary>The scene as a file</summary><pre>{}</pre></details>\n", text(scene))
        });
        format!(
            "<section id=\"made\"><h2>How this was made</h2>\n<dl class=\"facts\">{rows}</dl>\n{scene}\
             <p class=\"hint\"><code>palpate show report.html</code> reads this page back, every number to the last bit.</p></section>\n"
        )
    }
}
