//! Parquet for plain columns: pages, and the footer that says where they are.
//!
//! ```text
//! "PAR1"  (page header, 8 bytes a value)...  footer (FileMetaData)  its length (u32)  "PAR1"
//! ```
//!
//! Headers are Thrift's compact protocol: field numbers as differences, integers as zigzag varints.

pub(super) const MAGIC: &[u8] = b"PAR1";

/// Physical types.
const INT64: i64 = 2;
const DOUBLE: i64 = 5;

/// Where one group of rows stands.
#[derive(Clone, Debug)]
pub(super) struct RowGroup {
    start: u64,
    rows: u64,
    /// Offset and bytes of each column, the replicates first.
    chunks: Vec<(u64, u64)>,
}

/// All groups so far.
#[derive(Clone, Debug)]
pub(super) struct RowGroups {
    names: Vec<String>,
    groups: Vec<RowGroup>,
}

impl RowGroups {
    pub(super) fn new(names: &[String]) -> RowGroups {
        RowGroups::numbered("replicate", names)
    }

    /// Rows whose numbers stand in the column `number`.
    pub(super) fn numbered(number: &str, names: &[String]) -> RowGroups {
        let names = std::iter::once(number.to_string()).chain(names.iter().cloned()).collect();
        RowGroups { names, groups: Vec::new() }
    }

    /// The bytes of a group that begins at `start`.
    pub(super) fn encode(&self, start: u64, replicates: &[i64], columns: &[Vec<f64>]) -> (Vec<u8>, RowGroup) {
        let (mut bytes, mut chunks) = (Vec::new(), Vec::new());
        let first = replicates.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let rest = columns.iter().map(|column| column.iter().flat_map(|v| v.to_le_bytes()).collect());
        for page in std::iter::once(first).chain(rest) {
            let from = bytes.len();
            bytes.extend_from_slice(&page_header(page.len(), replicates.len()));
            bytes.extend_from_slice(&page);
            chunks.push((start + from as u64, (bytes.len() - from) as u64));
        }
        (bytes, RowGroup { start, rows: replicates.len() as u64, chunks })
    }

    pub(super) fn push(&mut self, group: RowGroup) {
        self.groups.push(group);
    }

    /// Gives the last group up; where it began.
    pub(super) fn pop(&mut self) -> Option<u64> {
        self.groups.pop().map(|group| group.start)
    }

    /// FileMetaData, its length and the end mark.
    pub(super) fn footer(&self) -> Vec<u8> {
        let mut t = Thrift::default();
        t.i32(1, 1);
        t.list(2, STRUCT, self.names.len() + 1);
        t.begin_element();
        t.string(4, "study");
        t.i32(5, self.names.len() as i64);
        t.end();
        for (k, name) in self.names.iter().enumerate() {
            t.begin_element();
            t.i32(1, if k == 0 { INT64 } else { DOUBLE });
            // required
            t.i32(3, 0);
            t.string(4, name);
            t.end();
        }
        t.i64(3, self.groups.iter().map(|group| group.rows as i64).sum());
        t.list(4, STRUCT, self.groups.len());
        for group in &self.groups {
            self.row_group(&mut t, group);
        }
        t.string(6, concat!("palpate ", env!("CARGO_PKG_VERSION")));
        t.end();
        let mut bytes = t.bytes;
        let length = bytes.len() as u32;
        bytes.extend_from_slice(&length.to_le_bytes());
        bytes.extend_from_slice(MAGIC);
        bytes
    }

    fn row_group(&self, t: &mut Thrift, group: &RowGroup) {
        t.begin_element();
        t.list(1, STRUCT, group.chunks.len());
        for (k, (offset, size)) in group.chunks.iter().enumerate() {
            t.begin_element();
            t.i64(2, *offset as i64);
            t.begin(3);
            t.i32(1, if k == 0 { INT64 } else { DOUBLE });
            t.list(2, I32, 1);
            t.element(0);
            t.list(3, BINARY, 1);
            t.text(&self.names[k]);
            t.i32(4, 0);
            t.i64(5, group.rows as i64);
            t.i64(6, *size as i64);
            t.i64(7, *size as i64);
            t.i64(9, *offset as i64);
            t.end();
            t.end();
        }
        t.i64(2, group.chunks.iter().map(|(_, size)| *size as i64).sum());
        t.i64(3, group.rows as i64);
        t.end();
    }
}

fn page_header(size: usize, rows: usize) -> Vec<u8> {
    let mut t = Thrift::default();
    // a data page
    t.i32(1, 0);
    t.i32(2, size as i64);
    t.i32(3, size as i64);
    t.begin(5);
    t.i32(1, rows as i64);
    // plain values; levels, of which required columns have none, by RLE
    t.i32(2, 0);
    t.i32(3, 3);
    t.i32(4, 3);
    t.end();
    t.end();
    t.bytes
}

const I32: u8 = 5;
const I64: u8 = 6;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const STRUCT: u8 = 12;

/// A writer of the compact protocol.
#[derive(Default)]
struct Thrift {
    bytes: Vec<u8>,
    /// Number of the last field, and of those around.
    last: i16,
    outer: Vec<i16>,
}

impl Thrift {
    fn varint(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.bytes.push(value as u8);
    }

    fn element(&mut self, value: i64) {
        self.varint(((value << 1) ^ (value >> 63)) as u64);
    }

    fn field(&mut self, id: i16, kind: u8) {
        // all differences here lie within 15
        self.bytes.push(((id - self.last) as u8) << 4 | kind);
        self.last = id;
    }

    fn i32(&mut self, id: i16, value: i64) {
        self.field(id, I32);
        self.element(value);
    }

    fn i64(&mut self, id: i16, value: i64) {
        self.field(id, I64);
        self.element(value);
    }

    fn text(&mut self, text: &str) {
        self.varint(text.len() as u64);
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn string(&mut self, id: i16, text: &str) {
        self.field(id, BINARY);
        self.text(text);
    }

    fn list(&mut self, id: i16, kind: u8, length: usize) {
        self.field(id, LIST);
        if length < 15 {
            self.bytes.push((length as u8) << 4 | kind);
        } else {
            self.bytes.push(0xf0 | kind);
            self.varint(length as u64);
        }
    }

    fn begin(&mut self, id: i16) {
        self.field(id, STRUCT);
        self.begin_element();
    }

    fn begin_element(&mut self) {
        self.outer.push(self.last);
        self.last = 0;
    }

    /// Ends a struct; the outermost one has none around it.
    fn end(&mut self) {
        self.bytes.push(0);
        self.last = self.outer.pop().unwrap_or(0);
    }
}
