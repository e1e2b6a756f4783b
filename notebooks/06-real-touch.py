# %% [markdown]
# # Real touch
#
# So far everything was simulated. This page starts from a file of contacts, as it would come from your robot, and knows no truth.
# Name yours and run the page again:
#
#     PALPATE_CONTACTS=my-contacts.csv notebooks/run --record 06
#
# A file needs a line for each contact with its place `x,y,z`. If the normals `nx,ny,nz` (the directions straight out of the surface) or
# the number of the `finger` are known, so much the better. When no file is named, a stand-in is read. It was not
# measured: `data/stand-in.toml` says which faults of a measurement it was given.

# %%
import os
from pathlib import Path

import palpate
import pandas as pd

from records import COLOURS, HERE, MARKERS, figure, footer

NAMED = os.environ.get("PALPATE_CONTACTS")
FILE = Path(NAMED) if NAMED else HERE / "data" / "stand-in.csv"
contacts = pd.read_csv(FILE, comment="#")
# where the file names no fingers, any five parts will do for what follows
fingers = contacts["finger"] if "finger" in contacts else pd.Series(range(len(contacts)), name="finger") % 5
contacts.describe().loc[["count", "min", "max"]].round(3)

# %% [markdown]
# Always look at the data first. Left is the view from above, right from the side.

# %%
figs, (above, side) = figure(2, height=3.4)
for k, (finger, of) in enumerate(contacts.groupby(fingers)):
    look = dict(linestyle="none", marker=MARKERS[k % len(MARKERS)], markersize=4, color=COLOURS[k % len(COLOURS)])
    above.plot(of["x"], of["y"], **look)
    side.plot(of["x"], of["z"], **look, label=f"finger {finger}")
above.set(xlabel="x", ylabel="y", title="from above", aspect="equal")
side.set(xlabel="x", ylabel="z", title="from the side")
# whole millimetres, without an offset written beside the axis
for axes in (above, side):
    axes.ticklabel_format(useOffset=False)
if fingers.nunique() <= 8:
    figs.legend(*side.get_legend_handles_labels(), loc="outside lower center", ncols=5)

# %% [markdown]
# ## What is it?
#
# `palpate.fit` of a table, like `palpate fit FILE`, with no other word compares six kinds of surface and says which of them
# explains the contacts best.

# %%
found = palpate.fit(contacts)
shape = found.shape
tried = pd.DataFrame((found.chosen or {}).get("tried", []))
tried.round(4)

# %% [markdown]
# *Probability* is how sure the choice is. *rms* is how far the contacts lie off each surface, in the file's unit. A surface with more
# freedom always comes nearer; it wins only if it comes so much nearer that chance does not explain it.


# %%
def limits(of):
    """Value and interval of S or R; nothing where they are undefined, as S of a plane is."""
    return pd.Series([of.mean, *(of.interval or [None, None])], index=["value", "from", "to"], dtype=float)


radius = pd.Series([shape.radius, *(shape.radius_interval or [None, None])], ["value", "from", "to"], dtype=float)
whole = {"S": limits(shape.S), "R": limits(shape.R)}
pd.DataFrame({"S, the kind of shape": whole["S"], "R, the strength of the bend": whole["R"], "radius": radius}).T.round(
    5
)

# %%
told = found.to_dict()["fit"]
lack = told.get("lack_of_fit") or {}
noise = [f"{name} {value:.3g}" for name, value in (told["sigma"] or {}).items() if value is not None]
print(f"class {shape.class_name}; noise found: {', '.join(noise)}; {lack.get('words', 'the misfit was not judged')}")

# %% [markdown]
# ## May I believe it?
#
# Nobody tells the truth here, so ask the contacts themselves: leave out one finger after the other, and see whether the
# others say the same. If one finger alone makes the answer, do not trust it.


# %%
def row(words, shape):
    """One line of the table: what was fitted, and S and R with their intervals."""
    known = {"S": limits(shape.S), "R": limits(shape.R)}
    return {"fitted": words, **{f"{name} {what}": value for name in "SR" for what, value in known[name].items()}}


rows = []
for finger in sorted(fingers.unique()):
    rows.append(row(f"without finger {finger}", palpate.fit(contacts[fingers != finger]).shape))
rows.append(row("all of them", shape))
parts_left_out = pd.DataFrame(rows)

figs, axes_of = figure(2, sharey=True, height=3.2)
places = list(range(len(parts_left_out)))[::-1]
for axes, name in zip(axes_of, "SR"):
    value = parts_left_out[f"{name} value"]
    axes.errorbar(
        value,
        places,
        xerr=[value - parts_left_out[f"{name} from"], parts_left_out[f"{name} to"] - value],
        fmt="o",
        color=COLOURS[0],
        capsize=3,
    )
    axes.axvspan(whole[name]["from"], whole[name]["to"], color=COLOURS[4], alpha=0.25, zorder=0)
    axes.set(xlabel=name, title={"S": "the kind of shape", "R": "the strength of the bend"}[name])
_ = axes_of[0].set_yticks(places, parts_left_out["fitted"])

# %% [markdown]
# The band is the interval of all contacts together. In the stand-in every answer's interval overlaps with it: no finger stands out.
#
# A harder test is to *predict*. Take a finger from the middle away, fit the others, and ask the fitted surface how high it is where
# that finger was (`surface.ev`). The differences should be no larger than the noise of a contact.

# %%
middle = sorted(fingers.unique())[fingers.nunique() // 2]
inside = contacts[fingers == middle]
surface = palpate.fit(contacts[fingers != middle]).surface
# a surface that stands up is no height over x and y, and cannot be asked so
is_height = isinstance(surface, palpate.Surface)
predicted = surface.ev(inside["x"], inside["y"]) if is_height else float("nan")
compared = pd.DataFrame(
    {
        "x": inside["x"].values,
        "y": inside["y"].values,
        "touched z": inside["z"].values,
        "predicted z": predicted,
    }
)
compared["difference"] = compared["touched z"] - compared["predicted z"]
compared.round(3)

# %% [markdown]
# ## The stand-in's secret
#
# Only for the stand-in: it was made from a pipe of radius 31.5 mm, tips that are believed 0.1 mm too small, noise of 0.08 mm and
# 2.5 degrees, a jump now and then. None of that was told to `palpate fit`.

# %%
overlaps = [
    # what is undefined, as S of a plane, is no contradiction
    ~((parts_left_out[f"{name} from"] > whole[name]["to"]) | (parts_left_out[f"{name} to"] < whole[name]["from"]))
    for name in "SR"
]
assert all(of.all() for of in overlaps), "leaving out one finger changes the answer by more than its interval"
if not NAMED:
    low, high = shape.radius_interval
    assert shape.class_name == "ridge" and low < 31.5 < high
    assert compared["difference"].abs().median() < 3 * told["sigma"]["z"]
footer(seed="1906 (the stand-in's)" if not NAMED else "none, measured")
