"""Surfaces as palpate writes them, opened by the programs that others use.

    python -m venv venv && venv/bin/pip install numpy scipy meshio vtk trimesh pyarrow cadquery-ocp
    venv/bin/python tests/formats/read_back.py target/debug/palpate            # prints the table
    venv/bin/python tests/formats/read_back.py target/debug/palpate --record   # and writes benches/runs/formats.md

Each file is written by `palpate ... --save`, read by an independent program, and its coordinates are held against those of
the surface as `palpate show surface.json` has it: control points and evaluated points of splines, vertices of meshes. The
script fails where a difference is larger than the format's own rounding.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

# Surfaces: a height field over x and y far from the origin, and one that stands up, as a map into space.
SURFACES = {
    "height field": ["run", "paper-cylinder", "--segments", "3", "--degree", "3"],
    "surface in space": ["run", "paper-fig6-r5.7-degree4", "--surface", "parametric"],
}
FLOAT32 = 2.0**-23
EXACT = 4.0 * 2.0**-52


def palpate(program, *arguments):
    subprocess.run([program, *arguments], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)


class Spline:
    """The surface of a palpate.fit/1 document, evaluated by SciPy."""

    def __init__(self, path):
        document = json.loads(Path(path).read_text())
        surface = document["surface"]
        self.kind = surface["kind"]
        self.t = [np.array(t) for t in surface["knots"]]
        self.c = np.array(surface["coefficients"])
        self.degree = surface["degree"]
        self.size = float(np.ptp(self.c if self.kind == "height" else self.c.reshape(-1, 3), axis=None))
        self.domain = [(t[p], t[-p - 1]) for t, p in zip(self.t, self.degree)]

    def points(self, u, v):
        from scipy.interpolate import NdBSpline

        u, v = np.asarray(u), np.asarray(v)
        found = NdBSpline(tuple(self.t), self.c, self.degree)(np.stack([u, v], axis=-1))
        return np.stack([u, v, found], axis=-1) if self.kind == "height" else found

    def lattice(self, n):
        axes = [np.linspace(lo, hi, n) for lo, hi in self.domain]
        return [a.ravel() for a in np.meshgrid(*axes, indexing="ij")]


def largest(a, b):
    assert a.shape == b.shape, (a.shape, b.shape)
    return float(np.max(np.abs(a - b)))


def occ_surface(shape):
    from OCP.BRep import BRep_Tool
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.GeomAbs import GeomAbs_BSplineSurface
    from OCP.GeomAdaptor import GeomAdaptor_Surface
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    assert BRepCheck_Analyzer(shape).IsValid(), "OpenCASCADE finds the shape faulty"
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    face = TopoDS.Face_s(explorer.Current()) if hasattr(TopoDS, "Face_s") else TopoDS.Face(explorer.Current())
    explorer.Next()
    assert not explorer.More(), "more than one face"
    surface = BRep_Tool.Surface_s(face)
    assert GeomAdaptor_Surface(surface).GetType() == GeomAbs_BSplineSurface, surface
    return surface


def against_spline(surface, spline):
    u, v = spline.lattice(17)
    found = np.array([[p.X(), p.Y(), p.Z()] for p in (surface.Value(a, b) for a, b in zip(u, v))])
    return largest(found, spline.points(u, v))


def read_step(path, spline, _):
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    reader.TransferRoots()
    return against_spline(occ_surface(reader.OneShape()), spline)


def read_iges(path, spline, _):
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.IGESControl import IGESControl_Reader

    reader = IGESControl_Reader()
    assert reader.ReadFile(str(path)) == IFSelect_RetDone
    reader.TransferRoots()
    return against_spline(occ_surface(reader.OneShape()), spline)


def read_npz(path, spline, _):
    from scipy.interpolate import NdBSpline, bisplev

    saved = np.load(path)
    u, v = spline.lattice(17)
    degree = saved["degree"].astype(int)
    if saved["c"].ndim == 2:
        axes = [np.unique(u), np.unique(v)]
        found = bisplev(*axes, (saved["tx"], saved["ty"], saved["c"].ravel(), *degree)).ravel()
        return largest(np.stack([u, v, found], axis=-1), spline.points(u, v))
    return largest(NdBSpline((saved["tx"], saved["ty"]), saved["c"], degree)(np.stack([u, v], axis=-1)), spline.points(u, v))


def vertices(points, _, table):
    """Meshes: vertices in the order of the Parquet table, which holds the same points."""
    return largest(np.asarray(points, dtype=float), table["points"])


def read_meshio(path, spline, table):
    import meshio

    mesh = meshio.read(path)
    if path.suffix == ".vtu":
        assert largest(mesh.point_data["R"], table["R"]) == 0.0, "R"
    if path.suffix == ".stl":
        return nearest(mesh.points, table)
    return vertices(mesh.points, spline, table)


def read_vtk(path, spline, table):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetPoints().GetDataType() == 11, "Float64"
    data = grid.GetPointData()
    assert data.GetNormals() is not None and largest(vtk_to_numpy(data.GetArray("S")), table["S"]) == 0.0
    return vertices(vtk_to_numpy(grid.GetPoints().GetData()), spline, table)


def read_trimesh(path, spline, table):
    import trimesh

    mesh = trimesh.load(path, process=False, force="mesh")
    assert len(mesh.faces) == table["faces"], (len(mesh.faces), table["faces"])
    # every triangle turns to the free side
    normals = np.asarray(mesh.face_normals)
    middle = table["normals"][np.asarray(mesh.faces)].sum(axis=1) if path.suffix != ".stl" else None
    assert middle is None or np.all(np.einsum("ij,ij->i", normals, middle) > 0.0), "a triangle turned away"
    return nearest(mesh.vertices, table) if path.suffix == ".stl" else vertices(mesh.vertices, spline, table)


def nearest(points, table):
    """STL repeats its corners: each is held against the nearest vertex."""
    from scipy.spatial import cKDTree

    _, at = cKDTree(table["points"]).query(points)
    return largest(np.asarray(points, dtype=float), table["points"][at])


def read_pyarrow(path, spline, _):
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    points = np.stack([table[name].to_numpy() for name in "xyz"], axis=-1)
    if spline.kind != "height":
        return on_surface(points, spline)
    return largest(points, spline.points(points[:, 0], points[:, 1]))


def on_surface(points, spline):
    """Distance of points from the nearest of a lattice that holds them: 49 x 49 over the domain."""
    u, v = spline.lattice(49)
    from scipy.spatial import cKDTree

    distance, _ = cKDTree(spline.points(u, v)).query(points)
    return float(distance.max())


READERS = [
    ("step", "OpenCASCADE", read_step, EXACT),
    ("igs", "OpenCASCADE", read_iges, EXACT),
    ("npz", "SciPy bisplev, NdBSpline", read_npz, EXACT),
    ("parquet", "pyarrow", read_pyarrow, EXACT),
    ("ply", "meshio", read_meshio, 0.0),
    ("ply", "trimesh", read_trimesh, 0.0),
    ("obj", "meshio", read_meshio, 0.0),
    ("obj", "trimesh", read_trimesh, 0.0),
    ("vtu", "VTK", read_vtk, 0.0),
    ("vtu", "meshio", read_meshio, 0.0),
    ("stl", "meshio", read_meshio, FLOAT32),
    ("stl", "trimesh", read_trimesh, FLOAT32),
    ("glb", "trimesh", read_trimesh, FLOAT32),
]


def rows_of(program, name, arguments, folder):
    document = folder / "surface.json"
    palpate(program, *arguments, "--save", str(document), "--quiet")
    spline = Spline(document)
    saved = {ending: folder / f"surface.{ending}" for ending, *_ in READERS}
    for path in saved.values():
        palpate(program, "show", str(document), "--save", str(path))
    table = mesh_table(saved["parquet"], saved["ply"])
    size = float(np.ptp(table["points"], axis=0).max())
    rows = []
    for ending, reader, read, allowed in READERS:
        difference = read(saved[ending], spline, table)
        assert difference <= allowed * max(size, 1.0) * 4.0, (ending, reader, difference)
        rows.append((name, f".{ending}", "out", reader, difference, difference / size))
    for ending in ("step", "igs"):
        again = folder / f"again-{ending}.json"
        palpate(program, "show", str(saved[ending]), "--save", str(again))
        back = Spline(again)
        assert back.kind == spline.kind and all(np.array_equal(a, b) for a, b in zip(back.t, spline.t))
        difference = largest(back.c, spline.c)
        assert difference == 0.0, "not to the same bits"
        rows.append((name, f".{ending}", "back", "palpate show", difference, difference / size))
        rows.append(foreign(program, name, ending, spline, folder, size))
    return rows


def foreign(program, name, ending, spline, folder, size):
    """The same spline written by OpenCASCADE, read by palpate."""
    path = folder / f"foreign.{ending}"
    write_occ(path, folder / f"surface.{ending}")
    again = folder / f"foreign-{ending}.json"
    palpate(program, "show", str(path), "--save", str(again))
    back = Spline(again)
    u, v = back.lattice(17)
    difference = largest(back.points(u, v), spline.points(u, v))
    assert difference <= 1e-9 * size, (ending, difference)
    return (name, f".{ending}", "in, written by OpenCASCADE", "palpate show", difference, difference / size)


def write_occ(path, source):
    if path.suffix == ".step":
        from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer

        reader = STEPControl_Reader()
        reader.ReadFile(str(source))
        reader.TransferRoots()
        writer = STEPControl_Writer()
        writer.Transfer(reader.OneShape(), STEPControl_AsIs)
        writer.Write(str(path))
    else:
        from OCP.IGESControl import IGESControl_Reader, IGESControl_Writer

        reader = IGESControl_Reader()
        reader.ReadFile(str(source))
        reader.TransferRoots()
        writer = IGESControl_Writer("MM", 0)
        writer.AddShape(reader.OneShape())
        writer.ComputeModel()
        writer.Write(str(path))


def mesh_table(parquet, ply):
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(parquet)
    stack = lambda names: np.stack([table[name].to_numpy() for name in names], axis=-1)
    head = ply.read_bytes().split(b"end_header")[0].decode()
    faces = int(head.split("element face ")[1].split()[0])
    out = {name: table[name].to_numpy() for name in ("S", "R", "k1", "k2")}
    return out | {"points": stack("xyz"), "normals": stack(["nx", "ny", "nz"]), "faces": faces}


# Bodies, and the kinds of surface that CAD has to find in their parts.step.
BODIES = {
    "parts-capsule": ["Cylinder", "Plane", "Sphere"],
    "parts-box": ["Plane"] * 3,
    "parts-cone": ["Cone", "Cylinder", "Plane", "Plane"],
    "parts-mug": ["Cylinder", "Cylinder", "Plane", "Plane", "Plane", "Torus"],
}


def parts_of(program, scene, folder):
    """The primitives of a body as OpenCASCADE has them: valid faces of the right kinds, and the contacts within noise of them."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepExtrema import BRepExtrema_DistShapeShape
    from OCP.gp import gp_Pnt
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    palpate(program, "parts", scene, "--out", str(folder / "out"), "--quiet")
    reader = STEPControl_Reader()
    assert reader.ReadFile(str(folder / "out" / "parts.step")) == IFSelect_RetDone
    reader.TransferRoots()
    shape = reader.OneShape()
    assert BRepCheck_Analyzer(shape).IsValid(), scene
    explorer, kinds = TopExp_Explorer(shape, TopAbs_FACE), []
    as_face = getattr(TopoDS, "Face_s", None) or TopoDS.Face
    while explorer.More():
        kinds.append(BRepAdaptor_Surface(as_face(explorer.Current())).GetType().name.split("_")[-1])
        explorer.Next()
    table = np.genfromtxt(folder / "out" / "parts.csv", delimiter=",", names=True)
    points = np.stack([table[name] for name in "xyz"], axis=-1)[::97]
    far = [BRepExtrema_DistShapeShape(BRepBuilderAPI_MakeVertex(gp_Pnt(*map(float, p))).Vertex(), shape).Value() for p in points]
    return sorted(kinds), float(np.median(far)), float(np.max(far)), float(np.ptp(points, axis=0).max())


def main():
    program = str(Path(sys.argv[1]).resolve())
    rows = []
    for name, arguments in SURFACES.items():
        with tempfile.TemporaryDirectory() as folder:
            rows += rows_of(program, name, arguments, Path(folder))
    for scene, kinds in BODIES.items():
        with tempfile.TemporaryDirectory() as folder:
            found, middle, far, size = parts_of(program, scene, Path(folder))
        assert found == kinds, (scene, found)
        assert middle < 0.01 * size, (scene, middle)
        rows.append((scene, "parts.step", "out", "OpenCASCADE", far, far / size))
    lines = ["| surface | format | direction | reader | largest coordinate difference | of the size |", "|---|---|---|---|---|---|"]
    for name, ending, direction, reader, difference, share in rows:
        lines.append(f"| {name} | {ending} | {direction} | {reader} | {difference:.1e} | {share:.1e} |")
    print("\n".join(lines))
    if "--record" in sys.argv:
        record(lines)


def record(lines):
    from importlib.metadata import version

    names = ["cadquery-ocp", "meshio", "numpy", "pyarrow", "scipy", "trimesh", "vtk"]
    versions = ", ".join(f"{name} {version(name)}" for name in names)
    words = f"""# Surfaces opened by other programs

`python tests/formats/read_back.py target/debug/palpate --record` writes each surface by `--save`, opens it by a program that
knows nothing of palpate, and holds its coordinates against the surface as it stands in the JSON: splines at 17 x 17 points,
meshes at every vertex. STL and glTF hold float32, and that is their difference; all others hold float64 or its digits. Where a
spline is evaluated by another program, the last bit of its arithmetic shows. "back" is `palpate show FILE` of palpate's own
file, coefficients and knots to the same bits. OpenCASCADE writes IGES with ten digits and STEP with fifteen.

Versions: {versions}.

"""
    path = Path(__file__).resolve().parents[2] / "benches" / "runs" / "formats.md"
    path.write_text(words + "\n".join(lines) + "\n")


main()
