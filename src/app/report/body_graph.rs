//! A body as a graph: parts are nodes, joints and relations are edges, for Graphviz (DOT) and for NetworkX, Gephi or yEd (GraphML).
//!
//! DOT: graphviz.org/doc/info/lang.html. GraphML: graphml.graphdrawing.org/specification.html.

use std::fmt::Write as _;
use std::io::Write;

use super::page::escaped;
use super::parts::{PartRecord, PartsDocument, size_words};

/// The parts and what lies between them, in the language of Graphviz; relations are dotted.
///
/// # Errors
/// What the system says.
pub(crate) fn write_dot(document: &PartsDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let quoted = |words: &str| words.replace('\\', "\\\\").replace('"', "\\\"");
    let mut text = format!("graph \"{}\" {{\n  node [shape=box];\n", quoted(&document.input));
    for part in &document.parts {
        let [name, size] = [named(part), size_words(part)].map(|words| quoted(&words));
        let _ = writeln!(text, "  {} [label=\"{name}\\n{size}\"];", part.id);
    }
    for joint in &document.joints {
        let [a, b] = joint.parts;
        let _ = writeln!(text, "  {a} -- {b} [label=\"{}, {:.1} degrees\"];", joint.kind, joint.angle_deg);
    }
    for relation in &document.relations {
        let [a, b] = relation.parts;
        let _ = writeln!(text, "  {a} -- {b} [label=\"{}\", style=dotted];", relation.kind.name());
    }
    text.push_str("}\n");
    out.write_all(text.as_bytes())
}

/// Attributes of nodes and edges: name, where, type.
const KEYS: [(&str, &str, &str); 12] = [
    ("kind", "node", "string"),
    ("class", "node", "string"),
    ("hollow", "node", "boolean"),
    ("points", "node", "int"),
    ("radius", "node", "double"),
    ("minor_radius", "node", "double"),
    ("half_angle_deg", "node", "double"),
    ("S", "node", "double"),
    ("R", "node", "double"),
    ("tie", "edge", "string"),
    ("angle_deg", "edge", "double"),
    ("probability", "edge", "double"),
];

/// The same as GraphML. An edge's `tie` is how parts meet (convex, concave, smooth) or what relates them.
///
/// # Errors
/// What the system says.
pub(crate) fn write_graphml(document: &PartsDocument, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
    );
    for (name, of, kind) in KEYS {
        let _ = writeln!(text, "  <key id=\"{name}\" for=\"{of}\" attr.name=\"{name}\" attr.type=\"{kind}\"/>");
    }
    let _ = writeln!(text, "  <graph id=\"{}\" edgedefault=\"undirected\">", escaped(&document.input));
    document.parts.iter().for_each(|part| node(part, &mut text));
    for joint in &document.joints {
        edge(joint.parts, &[("tie", joint.kind.clone()), ("angle_deg", joint.angle_deg.to_string())], &mut text);
    }
    for relation in &document.relations {
        let tie = relation.kind.name().to_string();
        edge(relation.parts, &[("tie", tie), ("probability", relation.probability.to_string())], &mut text);
    }
    text.push_str("  </graph>\n</graphml>\n");
    out.write_all(text.as_bytes())
}

fn node(part: &PartRecord, text: &mut String) {
    let number = |value: Option<f64>| value.map(|v| v.to_string());
    let values = [
        ("kind", Some(part.kind.clone())),
        ("class", part.class.clone()),
        ("hollow", Some(part.hollow.to_string())),
        ("points", Some(part.points.to_string())),
        ("radius", number(part.parameters.radius)),
        ("minor_radius", number(part.parameters.minor_radius)),
        ("half_angle_deg", number(part.parameters.half_angle_deg)),
        ("S", number(part.shape_index)),
        ("R", number(Some(part.curvedness))),
    ];
    let _ = writeln!(text, "    <node id=\"{}\">", part.id);
    for (key, value) in values.into_iter().filter_map(|(key, value)| Some((key, value?))) {
        let _ = writeln!(text, "      <data key=\"{key}\">{}</data>", escaped(&value));
    }
    text.push_str("    </node>\n");
}

fn edge([a, b]: [usize; 2], values: &[(&str, String)], text: &mut String) {
    let _ = writeln!(text, "    <edge source=\"{a}\" target=\"{b}\">");
    for (key, value) in values {
        let _ = writeln!(text, "      <data key=\"{key}\">{}</data>", escaped(value));
    }
    text.push_str("    </edge>\n");
}

fn named(part: &PartRecord) -> String {
    let inside = if part.hollow { ", seen from inside" } else { "" };
    format!("{} {}{inside}", part.id, part.kind)
}

#[cfg(test)]
mod tests {
    use super::super::parts_samples::parts_samples;
    use super::*;

    #[test]
    fn every_part_and_tie_is_in_the_graphs_and_no_name_ends_them() {
        let [mut document, _] = parts_samples();
        document.input = "a \"b\" <c>&.ply".into();
        let (mut dot, mut xml) = (Vec::new(), Vec::new());
        write_dot(&document, &mut dot).unwrap();
        write_graphml(&document, &mut xml).unwrap();
        let [dot, xml] = [dot, xml].map(|bytes| String::from_utf8(bytes).unwrap());
        assert!(dot.starts_with("graph \"a \\\"b\\\" <c>&.ply\" {"), "{dot}");
        assert_eq!(dot.matches(" -- ").count(), document.joints.len() + document.relations.len());
        assert_eq!(xml.matches("<edge ").count(), document.joints.len() + document.relations.len());
        assert_eq!(xml.matches("<node ").count(), document.parts.len());
        assert!(xml.contains("id=\"a &quot;b&quot; &lt;c&gt;&amp;.ply\""), "{xml}");
    }
}
