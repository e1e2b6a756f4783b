# %% [markdown]
# # Trust the interval
#
# A measurement without a margin is half an answer. palpate gives two numbers with each answer: the value, and an *interval* that
# should hold the truth 19 times in 20. This page checks that promise by playing dice: it repeats one simulated measurement
# thousands of times with fresh random errors, and counts.
#
# Each repetition is called a *replicate*. In a simulation we know the truth, so that counting is all there is to do.

# %%
import palpate
import pandas as pd

from records import COLOURS, figure, footer, palpate as command

# %% [markdown]
# ## The world
#
# A round bar of radius 25 mm lies at 30 degrees. Five fingers touch it at twelve places each. Every place is off by 0.05 mm or so in
# each direction, every direction by 3 degrees or so. This is the whole description; a scene is a small text file.

# %%
SEED = 4
BAR = f"""
name = "a bar"
seed = {SEED}

[surface]
kind = "cylinder"
radius = 25.0
axis_deg = 30.0

[sweep]
fingers = [-6.0, -3.0, 0.0, 3.0, 6.0]
from = -6.0
to = 6.0
stations = 12

[effects.position_noise]
sigma = 0.05

[effects.normal_noise]
sigma_deg = 3.0

[fit]
degree = 2
sigma = [0.05, 3.0]
"""

study = palpate.study(BAR, 20_000, keep_values=True)
replicates = pd.DataFrame(study.values)
replicates.head()

# %% [markdown]
# Each line is one whole experiment: fresh errors, a fresh fit, a fresh answer. Twenty thousand of them make a picture.

# %%
figs, parts = figure(2)
for axes, name in zip(parts, "SR"):
    of = study.quantities[name]
    axes.hist(replicates[name], bins=60, color=COLOURS[5], edgecolor="white", linewidth=0.3)
    axes.axvline(of.truth, color="black", linewidth=2, label="truth")
    axes.axvline(of.mean, color=COLOURS[1], linestyle="--", label="mean of the answers")
    axes.axvspan(of.lo, of.hi, color=COLOURS[4], alpha=0.25, zorder=0, label="95 of 100 answers")
    axes.set(xlabel=name, ylabel="replicates", title={"S": "kind of shape", "R": "strength of the bend, 1/mm"}[name])
_ = figs.legend(*parts[0].get_legend_handles_labels(), loc="outside lower center", ncols=3)

# %%
study.to_pandas()

# %% [markdown]
# | word | what it says |
# |---|---|
# | mean | the middle of all answers |
# | bias | how far that middle is from the truth: an error that no repetition averages away |
# | sd | how far a single answer usually is from the middle; two in three are nearer |
# | lo, hi | between these two lie 95 of 100 answers |
#
# The mean of S is nearly right. R comes out a little too small: a surface of degree 2 is a parabola, and a circle bends a little
# more. The answers' spread does not show that. Keep it in mind for the last part of this page.
#
# ## Which error is to blame?
#
# The study also tells how much of the spread each source of error causes. The shares add up to one, but for the noise of counting.

# %%
pd.DataFrame(study.effects).set_index("name")[["share_S", "share_R"]].round(3)

# %% [markdown]
# Here the errors of the places cause about three quarters of the spread of R: a better sensor of places would help more than
# a better sensor of directions.
#
# ## Does the promise hold?
#
# In reality there is one experiment and one interval. `palpate study --coverage` makes 200 experiments, computes the interval of
# each from that experiment alone, and counts how many hold the truth. Three kinds of interval are judged:
#
# * *linear*: computed from one fit of the surface that was named (degree 2), which takes microseconds;
# * *Monte Carlo*: the same surface, by dice;
# * *chosen*: no surface is named; palpate asks the contacts which kind of shape they show, as `palpate fit FILE` does.
#
# The bar is felt twice: over a small patch of 8 x 8 mm, and over a large one of 16 x 16 mm.

# %%
rows = []
for patch in (4, 8):
    scene = (
        BAR.replace("[-6.0, -3.0, 0.0, 3.0, 6.0]", str([patch * k / 2 for k in (-2, -1, 0, 1, 2)]))
        .replace("from = -6.0", f"from = -{patch}.0")
        .replace("to = 6.0", f"to = {patch}.0")
    )
    found = command("study", "-", "--coverage", "--replicates", 200, text=scene)["scenes"][0]
    for name in "SR":
        for kind in ("linear", "monte_carlo", "chosen"):
            judged = found[name][kind]
            rows.append(
                {
                    "patch": f"{2 * patch} x {2 * patch} mm",
                    "number": name,
                    "interval": kind.replace("_", " "),
                    "share": judged["share"],
                    "lo": judged["interval"][0],
                    "hi": judged["interval"][1],
                }
            )
coverage = pd.DataFrame(rows)

figs, parts = figure(2, sharex=True, sharey=True, height=3.2)
for axes, (patch, of) in zip(parts, coverage.groupby("patch", sort=False)):
    places = range(len(of))[::-1]
    axes.errorbar(
        of["share"], places, xerr=[of["share"] - of["lo"], of["hi"] - of["share"]], fmt="o", color=COLOURS[0], capsize=3
    )
    axes.axvline(0.95, color="black", linestyle=":")
    axes.set(
        title=f"felt over {patch}",
        xlabel="share of intervals that hold the truth",
        yticks=places,
        yticklabels=of["number"] + ", " + of["interval"],
    )

# %%
coverage.round(3)

# %% [markdown]
# The dotted line is the promise, 95 of 100; the bars around each point tell how well the counting itself is known.
#
# * For **S** every kind of interval holds.
# * For **R** the two intervals of the named surface miss the truth too often on the larger patch. They know about noise, and
#   nothing about a parabola not being a circle. That is the bias above.
# * The *chosen* interval counts the doubt about the kind of surface too, and holds. This is why `palpate fit FILE` names no model.
#
# The lesson: an interval is only as good as what it knows about. Name a model if you have a reason to, and else let palpate choose.

# %%
chosen = coverage[coverage["interval"] == "chosen"]
assert (chosen["hi"] >= 0.95).all(), "the chosen interval holds the truth less often than promised"
assert (
    coverage[(coverage["number"] == "R") & (coverage["interval"] == "linear")]["hi"].min() < 0.95
), "the named model's bias ought to show"
assert study.S.lo < study.S.truth < study.S.hi
assert abs(study.S.bias) < 0.2 * study.S.sd
assert study.effects[0]["name"] == "position_noise" and 0.6 < study.effects[0]["share_R"] < 0.9
footer(seed=SEED)
