//! Prints where the operators of Rust files stand and where their operands begin and end, one line each.
//!
//! ```text
//! binary FILE operator left-begin left-end right-begin right-end
//! unary  FILE operator operand-begin operand-end
//! arm    FILE begin pattern-end [guard-begin guard-end]                 a place is LINE:COLUMN, both from 1
//! ```

use proc_macro2::{LineColumn, Span};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

struct Places<'a> {
    file: &'a str,
}

/// As cargo-mutants counts them.
fn word(place: LineColumn) -> String {
    format!("{}:{}", place.line, place.column + 1)
}

fn ends(span: Span) -> String {
    format!("{} {}", word(span.start()), word(span.end()))
}

impl<'ast> Visit<'ast> for Places<'_> {
    fn visit_expr_binary(&mut self, node: &'ast syn::ExprBinary) {
        let operator = word(node.op.span().start());
        println!("binary {} {operator} {} {}", self.file, ends(node.left.span()), ends(node.right.span()));
        visit::visit_expr_binary(self, node);
    }

    fn visit_expr_unary(&mut self, node: &'ast syn::ExprUnary) {
        println!("unary {} {} {}", self.file, word(node.op.span().start()), ends(node.expr.span()));
        visit::visit_expr_unary(self, node);
    }

    fn visit_arm(&mut self, node: &'ast syn::Arm) {
        let pattern = ends(node.pat.span());
        let guard = node.guard.as_ref().map_or(String::new(), |(_, guard)| ends(guard.span()));
        println!("arm {} {pattern} {guard}", self.file);
        visit::visit_arm(self, node);
    }
}

fn main() {
    for file in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&file).expect("the file can be read");
        let tree = syn::parse_file(&text).expect("the file is Rust");
        Places { file: &file }.visit_file(&tree);
    }
}
