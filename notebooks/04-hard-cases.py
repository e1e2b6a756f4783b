# %% [markdown]
# # Hard cases
#
# A computer keeps about sixteen digits of every number. Each step of a computation may lose some of them, and a careless program
# loses them all without saying so. palpate says with every answer how many digits rounding is certain to have left: it
# *guarantees* them. This page looks at inputs that were made to be difficult, and compares the digits that were *guaranteed* with
# those that were *found*.
#
# (Rounding is not noise. An answer can be right to fourteen digits and still describe contacts that were badly measured. Noise is
# the matter of `02-trust-the-interval`.)

# %%
import re

import pandas as pd

from records import COLOURS, HERE, LINES, MARKERS, figure, footer, palpate

# %% [markdown]
# ## Some seventy inputs with a known answer
#
# For these inputs the answers were computed once with eighty digits. The file `benches/runs/hard-cases.md` holds what palpate found
# beside them. The command `cargo bench --bench hard_cases -- --record` writes it, and a test of the program computes every line
# of it anew, so that it cannot become out of date.

# %%
recorded = (HERE.parent / "benches" / "runs" / "hard-cases.md").read_text()
DIGITS = [f"{how} {what}" for how in ("found", "guaranteed", "allowed") for what in ("coefficients", "S", "R")]
rows, refused = [], []
for line in recorded.splitlines():
    if match := re.match(
        r"(\S+) +(\S+e\S+) +(cholesky|qr|pivoted qr|seminormal) +((?:[\d.-]+ +){8}[\d.-]+)(.*)$", line
    ):
        name, condition, method, digits, note = match.groups()
        rows.append(
            {
                "case": name,
                "condition": float(condition),
                "method": method,
                **dict(zip(DIGITS, digits.split())),
                "note": note.strip(),
            }
        )
    elif " refused: " in line:
        refused.append(line.split(" refused: ", 1))
cases = pd.DataFrame(rows)
cases[DIGITS] = cases[DIGITS].apply(pd.to_numeric, errors="coerce")
cases.sample(8, random_state=1).sort_index().drop(columns="note")

# %% [markdown]
# *Condition* says by how much rounding can grow on the way; 10 loses one digit. *Allowed* is what the data permit: if the last
# digit of one contact were different, the answer would differ from there on, whoever computes it.
#
# Each mark below is one case. Left of and above the line, more digits were found than were guaranteed: the promise held.

# %%
figs, (left, right) = figure(2, height=3.8)
for k, what in enumerate(("coefficients", "S", "R")):
    left.plot(
        cases[f"guaranteed {what}"],
        cases[f"found {what}"],
        linestyle="none",
        marker=MARKERS[k],
        markersize=5,
        markerfacecolor="none",
        label=what,
    )
left.plot([0, 16], [0, 16], color="black", linewidth=1)
left.set(xlabel="digits guaranteed", ylabel="digits found", title="does the guarantee hold?")
left.legend(loc="lower right")
for k, (method, of) in enumerate(cases.groupby("method")):
    right.plot(
        of["condition"],
        of["found coefficients"],
        linestyle="none",
        marker=MARKERS[k],
        markersize=5,
        markerfacecolor="none",
        label=method,
    )
right.set(
    xscale="log", xlabel="condition", ylabel="digits of coefficients found", title="which method for which problem?"
)
_ = right.legend(loc="lower left")

# %% [markdown]
# Where the condition is small, the fast method (Cholesky) finds all digits. Where it is large, palpate goes over to slower and
# more careful ones (QR), and says so. In the worst cases no digit is left, and none is promised.

# %%
pairs = [(cases[f"found {what}"], cases[f"guaranteed {what}"]) for what in ("coefficients", "S", "R")]
broken = sum((found < promised).sum() for found, promised in pairs)
judged = sum((found.notna() & promised.notna()).sum() for found, promised in pairs)
print(f"guaranteed above found: {broken} of {judged}")

# %% [markdown]
# Some questions have no answer. palpate then gives none, and says why:

# %%
pd.DataFrame([(case.strip(), why) for case, why in refused], columns=["case", "what palpate says"])

# %% [markdown]
# ## Make one yourself
#
# The recorded cases need the program's tests. This one needs only `palpate run`. The surface is a bowl turned upside down, a
# paraboloid, which every spline of degree 2 or more can follow exactly: whatever error comes out is rounding. With each degree the
# fit has more freedom than the contacts can hold, and the problem becomes harder.

# %%
SEED = 3
BOWL = f"""
name = "a bowl upside down"
seed = {SEED}

[surface]
kind = "paraboloid"
radii = [8.0, 20.0]

[sweep]
fingers = [-4.0, -2.0, 0.0, 2.0, 4.0]
from = -4.0
to = 4.0
stations = 12

[fit]
segments = 1
weights = "tangent"
"""
rows = []
for method in ("cholesky", "qr"):
    for degree in range(2, 10):
        document = palpate("run", "-", "--degree", degree, "--method", method, text=BOWL)
        rows.append(
            {
                "method": method,
                "degree": degree,
                "condition": document["fit"]["condition"],
                "guaranteed": document["fit"]["promise"]["S"],
                "error of S": document["truth"]["error_S"],
                "S": document["truth"]["S"],
            }
        )
bowl = pd.DataFrame(rows)
# an error of no more than this is what the guarantee allows
bowl["allowed by the guarantee"] = bowl["S"] * 10.0 ** -bowl["guaranteed"]

figs, (left, right) = figure(2, height=3.6)
for k, (method, of) in enumerate(bowl.groupby("method")):
    left.plot(of["degree"], of["condition"], color=COLOURS[k], marker=MARKERS[k], linestyle=LINES[k], label=method)
    right.plot(of["degree"], of["error of S"], color=COLOURS[k], marker=MARKERS[k], label=f"{method}: found")
    right.plot(
        of["degree"],
        of["allowed by the guarantee"],
        color=COLOURS[k],
        marker=MARKERS[k],
        markerfacecolor="none",
        linestyle=":",
        label=f"{method}: allowed",
    )
left.set(yscale="log", xlabel="degree", ylabel="condition", title="how hard the problem is")
left.legend()
right.set(yscale="log", xlabel="degree", ylabel="error of S", title="error of S by rounding alone")
_ = right.legend(fontsize=8)

# %% [markdown]
# The filled marks lie below the open ones everywhere: palpate promised less than it kept. It is careful, because it has to be right
# for every input with this condition, and this one is kinder than most.

# %%
assert broken == 0 and judged > 150
assert len(refused) >= 5
assert (bowl["error of S"] <= bowl["allowed by the guarantee"]).all()
assert bowl["guaranteed"].min() > 4
footer(seed=SEED)
