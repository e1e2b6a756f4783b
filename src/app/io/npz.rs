//! NPZ: 1-D arrays named like the columns, or 1-D `x` (n), `y` (m) and 2-D `z` (n x m): a grid.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::{Cursor, Read, Seek, Write};

use ndarray::{Array2, ShapeBuilder};
use zip::ZipArchive;

use palpate_geometry::contact::{Contacts, Grid};

use super::columns::{Column, Columns, Need, columns_of};
use super::depth::{self, DepthImage, Intrinsics};
use super::escape_control_chars::visible;
use super::names::{ColumnNames, in_our_words};
use super::npy::Header;
use super::npz_writer::NpzWriter;
use super::place::Unit;
use super::unpack::{limit, limit_words};
use super::{Input, IoError, ReadOptions, Reading};

/// No deflate stream unpacks to more than this many times its length (RFC 1951: 258 bytes from two bits).
const DEFLATE_LIMIT: u64 = 1032;

/// Most members of an archive. The largest in use have a few dozen.
const MOST_MEMBERS: usize = 1000;

/// A depth image, and what may stand beside it.
const DEPTH: &str = "depth";
const OF_DEPTH: [&str; 7] = ["fx", "fy", "cx", "cy", "K", "intrinsics", "depth_scale"];

/// An array as it came: shape and numbers in row-major order of that shape.
struct Array {
    header: Header,
    values: Vec<f64>,
}

/// Contacts or a grid from the bytes of an NPZ file.
pub(super) fn read(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Reading, IoError> {
    let (arrays, names) = read_arrays(file, bytes, options.columns.as_ref())?;
    if arrays.contains_key(DEPTH) {
        return read_depth(file, &arrays, options);
    }
    let two_dimensional = |name: &str| arrays.get(name).is_some_and(|a| a.header.shape.len() == 2);
    if ["z", "zx", "zy"].into_iter().any(two_dimensional) {
        return read_grid(file, arrays, &names, options);
    }
    let (columns, rows) = into_columns(file, arrays, &names, Need::Contacts)?;
    columns.into_reading(file, ((0..rows).collect(), Unit::Entry), options)
}

/// Contacts of a depth image; the intrinsics are those of the options, or arrays beside it.
fn read_depth(file: &str, arrays: &HashMap<String, Array>, options: &ReadOptions) -> Result<Reading, IoError> {
    let wrong = |what: String| IoError::Array { file: file.into(), array: DEPTH.into(), what };
    let image = match arrays.get(DEPTH) {
        Some(Array { header, values }) => DepthImage::of_array(&header.shape, header.fortran_order, values),
        None => None,
    };
    let image = image.ok_or_else(|| wrong("a depth image is 2-D, [row, column]".into()))?;
    let numbers = |name: &str| arrays.get(name).map(|array| array.values.as_slice()).unwrap_or_default();
    let four: Vec<f64> = ["fx", "fy", "cx", "cy"].iter().flat_map(|name| numbers(name)).copied().collect();
    let beside = [numbers("K"), numbers("intrinsics"), &four].into_iter().find(|values| !values.is_empty());
    let beside = beside.and_then(Intrinsics::of_array).map(|found| match numbers("depth_scale") {
        &[scale] if scale.is_finite() && scale > 0.0 => Intrinsics { scale, ..found },
        _ => found,
    });
    let intrinsics = options.intrinsics.or(beside).ok_or_else(|| {
        wrong(
            "its intrinsics are missing: give arrays fx, fy, cx, cy, or K (3 x 3), or --intrinsics FX,FY,CX,CY".into(),
        )
    })?;
    depth::read(file, &image, &intrinsics, options)
}

/// The 1-D arrays of an NPZ file that `need` asks for.
pub(super) fn read_columns(file: &str, bytes: &[u8], need: Need) -> Result<Columns, IoError> {
    let (arrays, names) = read_arrays(file, bytes, None)?;
    Ok(into_columns(file, arrays, &names, need)?.0)
}

fn into_columns(
    file: &str,
    mut arrays: HashMap<String, Array>,
    names: &[String],
    need: Need,
) -> Result<(Columns, usize), IoError> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut columns = Columns::named(file, &names, need)?;
    let rows = arrays.get("x").map_or(0, |x| x.values.len());
    for name in names {
        let Some(column) = Column::of(name).filter(|c| columns.has(*c)) else { continue };
        let Some(array) = arrays.remove(name) else { continue };
        let found = &array.header.shape;
        if found.len() != 1 || array.values.len() != rows {
            let what = format!("its shape is {found:?}; contacts take 1-D arrays of one length, x has {rows}");
            return Err(IoError::Array { file: file.into(), array: name.into(), what });
        }
        columns.set(column, array.values);
    }
    Ok((columns, rows))
}

fn read_grid(
    file: &str,
    mut arrays: HashMap<String, Array>,
    names: &[String],
    options: &ReadOptions,
) -> Result<Reading, IoError> {
    const KNOWN: [&str; 8] = ["x", "y", "z", "zx", "zy", "wz", "wx", "wy"];
    for normal in ["nx", "ny", "nz"] {
        if arrays.contains_key(normal) {
            let what = "a grid takes slopes zx = -nx/nz, zy = -ny/nz instead of normals".into();
            return Err(IoError::Array { file: file.into(), array: normal.into(), what });
        }
    }
    let x = axis(file, &mut arrays, "x")?;
    let y = axis(file, &mut arrays, "y")?;
    let mut map = |name: &str| arrays.remove(name).map(|array| into_map(file, name, array)).transpose();
    let (zx, zy, mut wz, wx, wy) = (map("zx")?, map("zy")?, map("wz")?, map("wx")?, map("wy")?);
    let z = match map("z")? {
        Some(z) => z,
        None => {
            // slopes only: heights of weight zero
            wz = Some(Array2::zeros((x.len(), y.len())));
            Array2::zeros((x.len(), y.len()))
        }
    };
    let mut grid = Grid { x, y, z, zx, zy, wz, wx, wy };
    let skipped = if options.skip_invalid { drop_infinities(&mut grid) } else { 0 };
    grid.check().map_err(|source| IoError::Contact { file: file.into(), source })?;
    let ignored = names.iter().filter(|name| !KNOWN.contains(&name.as_str())).map(|name| visible(name)).collect();
    let (input, file, notes) = (Input::Grid(grid), file.into(), Vec::new());
    Ok(Reading { input, file, skipped, ignored, places: None, notes, viewpoint: None, unit: None })
}

fn axis(file: &str, arrays: &mut HashMap<String, Array>, name: &'static str) -> Result<Vec<f64>, IoError> {
    let needed = "1-D x (n) and y (m), 2-D z (n x m), optionally zx, zy, wz, wx, wy";
    let Some(array) = arrays.remove(name) else {
        let found = arrays.keys().cloned().collect();
        return Err(IoError::MissingColumn { file: file.into(), column: name, found, needed });
    };
    if array.header.shape.len() != 1 {
        let what = format!("its shape is {:?}; a grid's axes are 1-D and increasing", array.header.shape);
        return Err(IoError::Array { file: file.into(), array: name.into(), what });
    }
    Ok(array.values)
}

fn into_map(file: &str, name: &str, array: Array) -> Result<Array2<f64>, IoError> {
    let wrong = |shape: &[usize]| IoError::Array {
        file: file.into(),
        array: name.into(),
        what: format!("its shape is {shape:?}; on a grid it is 2-D, [x, y]"),
    };
    let &[n, m] = &array.header.shape[..] else { return Err(wrong(&array.header.shape)) };
    let shape = (n, m).set_f(array.header.fortran_order);
    let map = Array2::from_shape_vec(shape, array.values).map_err(|_| wrong(&array.header.shape))?;
    Ok(if map.is_standard_layout() { map } else { map.as_standard_layout().into_owned() })
}

fn drop_infinities(grid: &mut Grid) -> usize {
    let mut dropped = 0;
    for map in [Some(&mut grid.z), grid.zx.as_mut(), grid.zy.as_mut()].into_iter().flatten() {
        for value in map.iter_mut().filter(|v| v.is_infinite()) {
            *value = f64::NAN;
            dropped += 1;
        }
    }
    dropped
}

/// Every array with a known name, and all names in the order of the file.
fn read_arrays(
    file: &str,
    bytes: &[u8],
    said: Option<&ColumnNames>,
) -> Result<(HashMap<String, Array>, Vec<String>), IoError> {
    let zip_error = |what: String| IoError::Zip { file: file.into(), what };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|e| zip_error(e.to_string()))?;
    if archive.len() > MOST_MEMBERS {
        return Err(zip_error(format!("{} members; up to {MOST_MEMBERS} are read", archive.len())));
    }
    let names = array_names(file, &archive, said)?;
    let mut arrays = HashMap::new();
    let mut unpacked = 0_u64;
    for (index, name) in names.iter().enumerate().filter_map(|(index, name)| Some((index, name.as_ref()?))) {
        let wanted = Column::of(name).is_some() || name == DEPTH || OF_DEPTH.contains(&name.as_str());
        if wanted {
            let mut member = archive.by_index(index).map_err(|e| zip_error(e.to_string()))?;
            let promised = member.size();
            unpacked = unpacked.saturating_add(promised);
            if promised > member.compressed_size().min(bytes.len() as u64).saturating_mul(DEFLATE_LIMIT) {
                return Err(zip_error(format!("member {name}.npy claims {promised} bytes")));
            }
            if unpacked > limit(bytes.len() as u64) {
                let words = limit_words(bytes.len() as u64);
                return Err(zip_error(format!("its arrays up to {name}.npy unpack to {words}")));
            }
            let array = read_array(&mut member, promised);
            let array = array.map_err(|what| IoError::Array { file: file.into(), array: name.clone(), what })?;
            arrays.insert(name.clone(), array);
        }
    }
    Ok((arrays, names.into_iter().flatten().collect()))
}

/// The name of every member's array in our words; `None` for members that are no arrays.
fn array_names(
    file: &str,
    archive: &ZipArchive<Cursor<&[u8]>>,
    said: Option<&ColumnNames>,
) -> Result<Vec<Option<String>>, IoError> {
    let members: Vec<&str> =
        (0..archive.len()).map(|index| archive.name_for_index(index).unwrap_or_default()).collect();
    let theirs: Vec<&str> = members.iter().filter_map(|name| name.strip_suffix(".npy")).collect();
    if theirs.is_empty() && !members.is_empty() {
        let is_workbook = members.iter().any(|name| name.starts_with("xl/"));
        let looks_like = if is_workbook { "an Excel workbook" } else { "a zip archive without arrays of NumPy" };
        return Err(IoError::Strange { file: file.into(), looks_like });
    }
    let mut seen = HashSet::new();
    if let Some(twice) = theirs.iter().find(|name| !seen.insert(**name)) {
        return Err(IoError::DuplicateColumn { file: file.into(), column: visible(twice) });
    }
    let mut ours = in_our_words(file, &theirs, said)?.into_iter();
    let name = |member: &&str| member.ends_with(".npy").then(|| ours.next().map(Cow::into_owned)).flatten();
    Ok(members.iter().map(name).collect())
}

/// `promised` is what the archive says the member unpacks to; the header must agree with it before memory is taken.
fn read_array(member: &mut impl Read, promised: u64) -> Result<Array, String> {
    /// NumPy pads headers to multiples of 64 and needs 128 bytes for any plain array; 64 KiB holds every version 1.
    const HEADER_ROOM: u64 = 65_546;
    let mut head = Vec::new();
    member.take(HEADER_ROOM).read_to_end(&mut head).map_err(|e| e.to_string())?;
    let header = Header::parse(&head)?;
    let data_bytes = header.data_bytes().filter(|&n| n as u64 == promised.saturating_sub(header.data_start as u64));
    let Some(data_bytes) = data_bytes else {
        return Err(format!("its header promises {:?} numbers, but the file holds {promised} bytes", header.shape));
    };
    let mut data = Vec::new();
    data.try_reserve_exact(data_bytes).map_err(|_| format!("{data_bytes} bytes do not fit into memory"))?;
    data.extend_from_slice(&head[header.data_start..]);
    let rest = (data_bytes + 1).saturating_sub(data.len()) as u64;
    member.take(rest).read_to_end(&mut data).map_err(|e| e.to_string())?;
    if data.len() != data_bytes {
        return Err(format!("its header promises {data_bytes} bytes of data, the file holds {}", data.len()));
    }
    let values = header.decode(&data);
    Ok(Array { header, values })
}

/// Writes contacts as 1-D arrays of float64 (labels too, so that every array has one type).
pub(super) fn write(contacts: &Contacts, remark: Option<&str>, out: impl Write + Seek) -> std::io::Result<()> {
    let mut npz = NpzWriter::stored(out);
    for (column, values) in columns_of(contacts) {
        npz.add(column.name(), &[values.len()], values.iter().copied())?;
    }
    if let Some(remark) = remark {
        let ones = std::iter::repeat_n(1.0, contacts.len());
        npz.add(&super::remark::array_name(remark), &[contacts.len()], ones)?;
    }
    npz.finish().map(drop)
}
