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
    use super::super::parts::{JointPart, PARTS_SCHEMA, PartsNoisePart};
    use super::super::relations::RelationRecord;
    use super::*;
    use palpate_inference::parts::{PartGeometry, PartUncertainty, RelationKind};

    /// A part that meets itself and is tied to itself.
    fn document(input: &str) -> PartsDocument {
        let part = PartRecord {
            id: 0,
            kind: "cone".into(),
            hollow: false,
            parameters: PartGeometry::default(),
            u: PartUncertainty::default(),
            class: None,
            other_class: None,
            shape_index: None,
            curvedness: 0.5,
            points: 1,
            extent: 0.5,
            misfit: 0.5,
            rejected: None,
            p: None,
            departure: 0.5,
        };
        let kind = RelationKind::EqualRadius;
        PartsDocument {
            schema: PARTS_SCHEMA,
            input: input.into(),
            contacts: 1,
            spacing: 0.5,
            noise: PartsNoisePart { distance: 0.5, normal_deg: 0.5 },
            tolerance: 0.5,
            parts: vec![part],
            joints: vec![JointPart { parts: [0, 0], kind: "convex".into(), angle_deg: 0.5, u_angle_deg: None }],
            relations: vec![RelationRecord { parts: [0, 0], kind, probability: 0.5, missed_by: 0.5, u: 0.5 }],
            objects: None,
            unassigned: 0,
            truth: None,
            notes: Vec::new(),
            seconds: 0.5,
        }
    }

    #[test]
    fn every_part_and_tie_is_in_the_graphs_and_no_name_ends_them() {
        let document = document("a \"b\" <c>&.ply");
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
