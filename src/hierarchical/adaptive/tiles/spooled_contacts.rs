//! Contacts that come once, in pieces, and are more than memory holds: written to a folder as they come, sorted into tiles there.
//!
//! ```text
//! pieces -> raw file, bounds -> pieces sorted, cut by tile -> tiles merged, one at a time       memory: a piece, a tile
//! ```

use std::fs::{self, File};
use std::io::{BufReader, BufWriter, Read, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::contact_run::{ContactRun, TileGround};
use super::contact_tile::{ContactTile, beside_tile};
use super::packed::{Packer, Unpacker, damaged};
use super::tile_extent::TileExtent;
use super::tile_question::TileQuestion;
use super::tiled_passes::TileSource;
use crate::adaptive::answer::AdaptiveFit;
use crate::adaptive::ground::ContactBounds;
use crate::adaptive::options::AdaptiveOptions;
use crate::equations::{ColumnKind, columns_of};
use crate::error::HierarchyError;
use palpate_geometry::contact::Contacts;

/// Contacts on their way into a folder, which is removed with what is in it.
#[derive(Debug)]
pub struct ContactSpool {
    folder: PathBuf,
    raw: BufWriter<File>,
    /// Contacts of every piece.
    pieces: Vec<usize>,
    kind: Option<ColumnKind>,
    bounds: ContactBounds,
}

/// Tiles in a folder, which is removed with them.
#[derive(Debug)]
pub struct StoredTiles {
    folder: PathBuf,
    ground: TileGround,
    roots: Vec<Range<usize>>,
    counts: Vec<usize>,
    /// First and last contacts of every tile, for those beside it.
    edges: Vec<[ContactRun; 2]>,
    extents: Vec<TileExtent>,
}

fn failed(error: std::io::Error) -> HierarchyError {
    HierarchyError::Parts { what: error.to_string() }
}

/// One block of bytes behind its length.
fn write_block(file: &mut impl Write, bytes: &[u8]) -> Result<(), HierarchyError> {
    file.write_all(&(bytes.len() as u64).to_le_bytes()).map_err(failed)?;
    file.write_all(bytes).map_err(failed)
}

fn read_block(file: &mut impl Read) -> Result<Vec<u8>, HierarchyError> {
    let mut length = [0; 8];
    file.read_exact(&mut length).map_err(failed)?;
    let mut bytes = Vec::new();
    let wanted = u64::from_le_bytes(length);
    let read = file.take(wanted).read_to_end(&mut bytes).map_err(failed)?;
    if read as u64 == wanted { Ok(bytes) } else { Err(damaged()) }
}

impl ContactSpool {
    /// Into a folder that does not exist yet.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn new(folder: &Path) -> Result<ContactSpool, HierarchyError> {
        fs::create_dir(folder).map_err(failed)?;
        let raw = BufWriter::new(File::create_new(folder.join("raw")).map_err(failed)?);
        Ok(ContactSpool { folder: folder.into(), raw, pieces: Vec::new(), kind: None, bounds: ContactBounds::NONE })
    }

    /// Takes a piece.
    ///
    /// # Errors
    /// Faulty contacts, other columns than before, a full disk.
    pub fn add(&mut self, contacts: &Contacts) -> Result<(), HierarchyError> {
        if contacts.is_empty() {
            return Ok(());
        }
        contacts.check()?;
        let kind = ColumnKind::of(contacts);
        if self.kind.is_some_and(|before| before != kind) {
            return Err(HierarchyError::Parts { what: "some come with columns that others lack".into() });
        }
        let mut packer = Packer::default();
        columns_of(contacts).iter().for_each(|column| packer.reals(column));
        write_block(&mut self.raw, &packer.bytes)?;
        self.kind = Some(kind);
        self.pieces.push(contacts.len());
        self.bounds = self.bounds.with(ContactBounds::of(contacts));
        Ok(())
    }

    /// x and y of every `step`-th contact of all that came, from the first on.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn places(&mut self, step: usize) -> Result<Vec<[f64; 2]>, HierarchyError> {
        let Some(kind) = self.kind else { return Ok(Vec::new()) };
        self.raw.flush().map_err(failed)?;
        let mut places = Vec::new();
        self.each_piece(kind, |first, contacts| {
            let here = first.next_multiple_of(step.max(1))..first + contacts.len();
            places.extend(here.step_by(step.max(1)).map(|r| [contacts.x[r - first], contacts.y[r - first]]));
            Ok(())
        })?;
        Ok(places)
    }

    /// Sorts everything into tiles of at most so many contacts, or of one base cell where that has more.
    ///
    /// # Errors
    /// Faulty options, contacts that span no rectangle or lie outside of the domain, a full disk.
    pub fn sorted(mut self, options: &AdaptiveOptions, most: usize) -> Result<StoredTiles, HierarchyError> {
        let Some(kind) = self.kind else { return Err(HierarchyError::Parts { what: "no contacts".into() }) };
        self.raw.flush().map_err(failed)?;
        let ground = TileGround::of(&self.bounds, options)?;
        let mut by_root = vec![0; ground.roots()];
        self.each_run(kind, &ground, |run| {
            by_root.iter_mut().zip(run.by_root(&ground)).for_each(|(sum, count)| *sum += count);
            Ok(())
        })?;
        let roots = tiles_of_roots(&by_root, most);
        self.each_run(kind, &ground, |run| {
            for (tile, roots) in roots.iter().enumerate() {
                let piece = run.of_roots(roots.clone());
                let path = self.folder.join(format!("pieces-{tile}"));
                let mut file = File::options().create(true).append(true).open(path).map_err(failed)?;
                write_block(&mut file, &piece.pack())?;
            }
            Ok(())
        })?;
        fs::remove_file(self.folder.join("raw")).map_err(failed)?;
        let mut tiles = StoredTiles {
            folder: std::mem::take(&mut self.folder),
            ground,
            roots,
            counts: Vec::new(),
            edges: Vec::new(),
            extents: Vec::new(),
        };
        tiles.merge(self.pieces.len())?;
        Ok(tiles)
    }

    fn each_run(
        &self,
        kind: ColumnKind,
        ground: &TileGround,
        mut take: impl FnMut(&ContactRun) -> Result<(), HierarchyError>,
    ) -> Result<(), HierarchyError> {
        self.each_piece(kind, |first, contacts| take(&ContactRun::of(&contacts, ground, first)?))
    }

    /// All pieces in their order, each with the number of its first contact.
    fn each_piece(
        &self,
        kind: ColumnKind,
        mut take: impl FnMut(usize, Contacts) -> Result<(), HierarchyError>,
    ) -> Result<(), HierarchyError> {
        let mut raw = BufReader::new(File::open(self.folder.join("raw")).map_err(failed)?);
        let mut first = 0;
        for count in &self.pieces {
            let bytes = read_block(&mut raw)?;
            let mut reader = Unpacker::new(&bytes);
            let columns = (0..kind.count()).map(|_| reader.reals()).collect::<Result<_, _>>()?;
            take(first, kind.contacts(columns))?;
            first += count;
        }
        Ok(())
    }
}

impl Drop for ContactSpool {
    fn drop(&mut self) {
        // taken over by the tiles where it is empty; nobody can be told of a folder that stays
        if !self.folder.as_os_str().is_empty() {
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

impl Drop for StoredTiles {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Runs of base cells with at most so many contacts, at least one cell each.
fn tiles_of_roots(by_root: &[usize], most: usize) -> Vec<Range<usize>> {
    let mut tiles: Vec<Range<usize>> = Vec::new();
    let mut held = 0;
    for (root, count) in by_root.iter().enumerate() {
        match tiles.last_mut() {
            Some(tile) if held + count <= most => tile.end = root + 1,
            _ => {
                tiles.push(root..root + 1);
                held = 0;
            }
        }
        held += count;
    }
    tiles
}

impl StoredTiles {
    /// Cuts every tile's pieces together, and puts to each what lies beside it.
    fn merge(&mut self, pieces: usize) -> Result<(), HierarchyError> {
        self.merge_own(pieces)?;
        (0..self.len()).try_for_each(|tile| {
            let whole = self.with_sides(tile)?;
            self.extents.push(whole.extent());
            fs::write(self.path(tile), whole.pack()).map_err(failed)
        })
    }

    fn merge_own(&mut self, pieces: usize) -> Result<(), HierarchyError> {
        for tile in 0..self.roots.len() {
            let path = self.folder.join(format!("pieces-{tile}"));
            let mut file = BufReader::new(File::open(&path).map_err(failed)?);
            let runs: Vec<ContactRun> =
                (0..pieces).map(|_| ContactRun::unpack(&read_block(&mut file)?)).collect::<Result<_, _>>()?;
            let run = ContactRun::merged(&runs)?;
            fs::remove_file(path).map_err(failed)?;
            fs::write(self.path(tile), run.pack()).map_err(failed)?;
            let most = beside_most().min(run.len());
            self.edges.push([run.slice(0..most), run.slice(run.len() - most..run.len())]);
            self.counts.push(run.len());
        }
        Ok(())
    }

    fn path(&self, tile: usize) -> PathBuf {
        self.folder.join(format!("tile-{tile}"))
    }

    /// Tiles.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// A base grid has at least one cell.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// Frame and base grid.
    pub fn ground(&self) -> &TileGround {
        &self.ground
    }

    fn tile(&self, tile: usize) -> Result<ContactTile, HierarchyError> {
        ContactTile::unpack(&fs::read(self.path(tile)).map_err(failed)?)
    }

    fn with_sides(&self, tile: usize) -> Result<ContactTile, HierarchyError> {
        let own = ContactRun::unpack(&fs::read(self.path(tile)).map_err(failed)?)?;
        let ([earlier, later], before) = beside_tile(&self.counts, tile);
        let tail = |(other, range): &(usize, Range<usize>)| {
            let edge = &self.edges[*other][1];
            edge.slice(edge.len() - range.len()..edge.len())
        };
        let head = |(other, range): &(usize, Range<usize>)| self.edges[*other][0].slice(range.clone());
        let beside = [earlier.iter().map(tail).collect(), later.iter().map(head).collect()];
        let total = self.counts.iter().sum();
        ContactTile::new(&self.ground, self.roots[tile].clone(), own, beside, [before, total])
    }

    /// What a fit must know of the tiles.
    pub fn extents(&self) -> &[TileExtent] {
        &self.extents
    }
}

/// Contacts of a tile that another one may ask for on one side.
fn beside_most() -> usize {
    let ([_, later], _) = beside_tile(&[0, usize::MAX / 2], 0);
    later.iter().map(|(_, range)| range.len()).sum()
}

impl TileSource for StoredTiles {
    fn answers(&mut self, questions: Vec<TileQuestion>) -> Result<Vec<Vec<f64>>, HierarchyError> {
        questions.iter().enumerate().map(|(tile, question)| self.tile(tile)?.answer(question)).collect()
    }
}

/// Fits contacts that come in pieces, each once, in memory for a piece and `most` contacts: to the bits what
/// [`fit_adaptive`](crate::adaptive::fit_adaptive) makes of all of them. `folder` is made, used and removed.
///
/// # Errors
/// Those of a fit, of the pieces, and of files.
pub fn fit_spooled(
    pieces: impl IntoIterator<Item = Result<Contacts, HierarchyError>>,
    options: &AdaptiveOptions,
    folder: &Path,
    most: usize,
) -> Result<AdaptiveFit, HierarchyError> {
    options.check()?;
    let mut spool = ContactSpool::new(folder)?;
    pieces.into_iter().try_for_each(|piece| spool.add(&piece?))?;
    let mut tiles = spool.sorted(options, most)?;
    let (extents, ground) = (tiles.extents().to_vec(), tiles.ground().clone());
    super::fit_tiles(&ground, &extents, &mut tiles, options)
}
