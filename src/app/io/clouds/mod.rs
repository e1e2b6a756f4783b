//! Point clouds and meshes as other programs write them: every vertex is a contact, and of coarse meshes every part of the
//! [facets](crate::io::facets).
//!
//! ```text
//! PCD    x y z [normal_x normal_y normal_z]     ascii, binary, compressed
//! OFF    x y z [nx ny nz] in NOFF               faces, where coarse
//! OBJ    v x y z, vn x y z                      faces, where coarse; else they say which normal belongs to which vertex
//! STL    triangles                              vertices joined, normals from the triangles around each
//! NPY    n x 3 or n x 6                         x, y, z [nx, ny, nz]
//! ```

mod lzf;
mod npy_table;
mod obj;
mod off;
mod pcd;
mod soup;
mod stl;

pub(super) use npy_table::read as read_npy;
pub(super) use obj::read as read_obj;
pub(super) use off::read as read_off;
pub(super) use pcd::read as read_pcd;
pub(super) use stl::read as read_stl;
