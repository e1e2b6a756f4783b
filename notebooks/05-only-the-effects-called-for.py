# %% [markdown]
# # Only the effects called for
#
# A real finger errs in many ways: its tip is not as large as the robot believes, it sinks in, it rubs, its sensor is noisy. palpate
# can simulate fourteen such *effects*. A scene switches on those it names, and no other. This page switches them on one by one, and
# asks of each: what does it do to S and R, and what does it cost to simulate?

# %%
import palpate
import pandas as pd

from records import COLOURS, figure, footer

# %% [markdown]
# The object is a round bar of radius 12 mm. Without any effect, five fingers find S exactly and R to within a thousandth.

# %%
SEED = 7
BAR = f"""
name = "a bar"
seed = {SEED}

[surface]
kind = "cylinder"
radius = 12.0
axis_deg = 90.0

[sweep]
fingers = [-4.0, -2.0, 0.0, 2.0, 4.0]
from = -4.0
to = 4.0
stations = 12
tip_radius = 2.0

[fit]
degree = 4
weights = "tangent"
"""

# what is written into the scene, and what it means
EFFECTS = {
    "tip_radius_error": ("error = -0.3", "the robot believes its tips to be 0.3 mm smaller than they are"),
    "indentation": ("modulus = 30.0\nthreshold = 0.5\novershoot = 0.3", "soft tips sink in before they feel"),
    "friction": ("mu = 0.1\nsigma = 0.02", "the force leans against the sliding, and the normal with it"),
    "force_noise": ("sigma = 0.03\nbias = [0.03, 0.0, 0.0]", "the force sensor errs by 3 %, and leans to one side"),
    "position_noise": ("sigma = 0.02", "places are off by 0.02 mm"),
    "normal_noise": ("sigma_deg = 2.0", "directions are off by 2 degrees"),
    "slope_gain": ("relative = 0.05", "directions all lean 5 % too far"),
    "encoder": ("sigma_deg = 0.02\nresolution_deg = 0.02", "joint angles err, and come in steps"),
    "misalignment": ("rotation_deg = [0.0, 5.0, 0.0]", "the robot's base stands askew by 5 degrees"),
    "latency": ("distance = 0.2\njitter = 0.1", "places are read a moment too late"),
    "finger_noise": ("sigma_deg = 2.0\nlength = 4.0", "directions are off by 2 degrees, alike over 4 mm of a path"),
    "slip": ("probability = 0.02\nsize = 0.5", "now and then a finger jumps by half a millimetre"),
    "dropout": ("probability = 0.1", "one reading in ten is lost"),
    "row_noise": ("sigma_z = 0.02\nsigma_slope = 0.03", "heights and slopes err, places are exact"),
}


def scene(*effects):
    return BAR + "".join(f"\n[effects.{name}]\n{keys}\n" for name, keys in effects)


# %% [markdown]
# `palpate.study` repeats each scene 2,000 times with fresh random numbers.

# %%
rows = []
for name in ("none", *EFFECTS):
    text = scene() if name == "none" else scene((name, EFFECTS[name][0]))
    # the fastest of five: whatever else the machine does only adds to the time
    studies = [palpate.study(text, 2000, attribution=0) for _ in range(5)]
    S, R, told = studies[0].S, studies[0].R, [study.to_dict() for study in studies]
    rows.append(
        {
            "effect": name,
            "shift of S": S.bias,
            "spread of S": S.sd,
            "shift of R, %": 100 * R.bias / R.truth,
            "spread of R, %": 100 * R.sd / R.truth,
            "microseconds": min(1e6 / study["replicates_per_second"] for study in told),
            "path": told[0]["path"],
        }
    )
effects = pd.DataFrame(rows).set_index("effect")

figs, parts = figure(3, height=4.2, width=9.5, sharey=True)
places = list(range(len(effects)))[::-1]
for axes, name, unit in ((parts[0], "S", ""), (parts[1], "R", ", %")):
    axes.errorbar(
        effects[f"shift of {name}{unit}"],
        places,
        xerr=effects[f"spread of {name}{unit}"],
        fmt="o",
        color=COLOURS[0],
        markersize=4,
        capsize=2,
    )
    axes.axvline(0, color="black", linewidth=1, linestyle=":")
    axes.set(title=f"what it does to {name}", xlabel=f"{name} found - true{unit}")
parts[2].barh(
    places,
    effects["microseconds"],
    color=[COLOURS[1] if path == "refit" else COLOURS[5] for path in effects["path"]],
    edgecolor="black",
    linewidth=0.5,
)
parts[2].set(title="what it costs", xscale="log", xlabel="microseconds a replicate, fit included")
_ = parts[0].set_yticks(places, effects.index)

# %% [markdown]
# Left and middle: the dot is how far the mean answer is off (no repetition averages that away), the bar how much single answers
# spread. Right: blue bars keep the places of the contacts, so that one factorisation serves all replicates; orange bars move them,
# and each replicate is fitted from the start.

# %%
effects.round({"shift of S": 5, "spread of S": 5, "shift of R, %": 3, "spread of R, %": 3, "microseconds": 1}).assign(
    meaning=[""] + [meaning for _, meaning in EFFECTS.values()]
)

# %% [markdown]
# What to read from it:
#
# * **Errors of directions do most.** Noise of the normals by 2 degrees or of the force by 3 % moves S and R far more than places that
#   are off by 0.02 mm. (These weights trust directions.)
# * **Noise does not only spread, it shifts.** Noisy directions make every surface look a little more bent than it is: R is never
#   negative, so that errors do not cancel in it.
# * **The size of the tip shifts and does not spread, and so do directions that all lean too far.** No repetition shows either. Measure
#   your tips, and calibrate what tells directions. (`palpate fit` without a named model asks whether directions and places agree.)
# * **Some effects do nothing to the shape.** A robot that stands askew, readings that come late or are lost do not change what kind of
#   thing was touched.
#
# ## An effect that is not called for
#
# An effect whose strength is zero is not simulated at all: the answers are the same to the last digit. And each effect has
# random numbers of its own, so that switching one on leaves the errors of the others as they were. Here one reading in ten is
# lost; the readings that are left have exactly the errors that they had.

# %%
noise = ("position_noise", EFFECTS["position_noise"][0])
dropout = ("dropout", EFFECTS["dropout"][0])
zero = palpate.study(scene(noise, ("normal_noise", "sigma_deg = 0.0")), 2000, attribution=0)
plain = palpate.study(scene(noise), 2000, attribution=0)
complete = pd.DataFrame(palpate.simulate(scene(noise)))
thinned = pd.DataFrame(palpate.simulate(scene(noise, dropout)))
kept = thinned.merge(complete)
print(f"{len(complete)} readings; with dropout {len(thinned)}, of which {len(kept)} are the same to the last digit")

# %%
assert plain.S == zero.S and plain.R == zero.R
assert 0 < len(thinned) < len(complete) and len(kept) == len(thinned)
assert abs(effects.loc["none", "shift of S"]) < 1e-9 and effects.loc["none", "spread of R, %"] == 0
assert effects.loc["normal_noise", "spread of S"] > 10 * effects.loc["position_noise", "spread of S"]
assert effects.loc["tip_radius_error", "shift of R, %"] < -1 and effects.loc["tip_radius_error", "spread of R, %"] == 0
footer(seed=SEED)
