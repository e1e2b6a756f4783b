"""Parts of real scans: what `palpate parts` makes of every point cloud in a directory, with default options.

    python benches/peers/scans.py PALPATE DIRECTORY [--truth TRUTH.jsonl] [--record benches/runs/scans.md]

Needs Python alone. TRUTH.jsonl has one object a line with `file`, `radius` and `kind` (cap, cup, ridge or rut) of scans that show one
ball or one pipe; every part beside the largest is then a false one. Files without an object are listed without a judgement.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

CLOUDS = {".csv", ".xyz", ".ply", ".pcd", ".obj", ".off", ".stl", ".npy"}
KINDS = {"cap": "sphere", "cup": "sphere", "ridge": "cylinder", "rut": "cylinder"}


def parts(program, path):
    run = subprocess.run([program, "parts", str(path), "--json"], capture_output=True, text=True)
    if run.returncode:
        return None, run.stderr.strip().split("\n")[0].replace(str(path), path.name)
    return json.loads(run.stdout), None


def size(part):
    """The size that tells most, with its standard uncertainty."""
    names = {"half_angle_deg": "half angle", "radius": "radius", "minor_radius": "tube"}
    words = []
    for key, name in names.items():
        value, u = part["parameters"].get(key), part["u"].get(key)
        if value is not None:
            words.append(f"{name} {value:.4g}" + (f" +- {u:.2g}" if u is not None else ""))
    return ", ".join(words) or "-"


def row(path, found, truth):
    first = found["parts"][0]
    share = 100 * first["points"] / found["contacts"]
    cells = [path.name, f"{found['contacts']:,}", str(len(found["parts"])), first["kind"], f"{share:.1f} %", size(first)]
    cells.append({True: f"yes, by {first['departure']:.2g}", False: "no", None: "-"}[first["rejected"]])
    if truth:
        radius, u = first["parameters"].get("radius"), first["u"].get("radius")
        kind = "right" if first["kind"] == KINDS.get(truth.get("kind")) else "wrong"
        off = f"{(radius - truth['radius']) / u:+.1f} u" if radius is not None and u else "-"
        cells += [f"{truth['radius']:.4g}", kind, off]
    else:
        cells += ["-", "-", "-"]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("directory", type=Path)
    parser.add_argument("--truth", type=Path)
    parser.add_argument("--record", type=Path)
    asked = parser.parse_args()
    truths = {}
    if asked.truth:
        lines = (json.loads(line) for line in asked.truth.read_text().splitlines() if line.strip())
        truths = {line["file"]: line for line in lines}
    heads = ["scan", "contacts", "parts", "largest", "its share", "size", "rejected", "true radius", "kind", "radius off by"]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    files = sorted(path for path in asked.directory.iterdir() if path.suffix in CLOUDS)
    if not files:
        sys.exit(f"{asked.directory} holds no point cloud ({', '.join(sorted(CLOUDS))})")
    for path in files:
        found, refused = parts(asked.program, path)
        lines.append(row(path, found, truths.get(path.name)) if found else f"| {path.name} | refused: {refused} |" + " |" * (len(heads) - 2))
        print(lines[-1], flush=True)
    if asked.record:
        head = (
            "# Parts of real scans\n\n`python benches/peers/scans.py PALPATE DIRECTORY --truth TRUTH.jsonl --record benches/runs/scans.md`, default options. "
            "Every scan with a true radius shows one ball or one pipe, so that parts beside the largest are false ones. "
            "`rejected`: whether the data reject the primitive at 1 %, and by how much they are off.\n\n"
        )
        asked.record.write_text(head + "\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
