"""A script that repeats the analysis in R with psych and GPArotation, so that nobody need trust ours."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from survey.export.cells import safe_cell

__all__ = ["Replication", "write_r"]

_SCRIPT = r"""# Repeats `survey analyse` in R.   Rscript @NAME@ [answers.csv [out.json]]
# install.packages(c("psych", "GPArotation", "jsonlite"))
suppressMessages({library(psych); library(GPArotation)})
given <- commandArgs(trailingOnly = TRUE)
file <- if (length(given) > 0) given[1] else "@FILE@"

items <- c(@ITEMS@)
dropped <- c(@DROPPED@)
answers <- read.csv(file, fileEncoding = "UTF-8-BOM", na.strings = c("", "NA", "."), check.names = FALSE)
# A name that a spreadsheet would run as a formula stands in our files behind an apostrophe.
guarded <- c(@GUARDED@)
scores <- as.matrix(answers[, ifelse(items %in% names(answers), items, guarded)])
colnames(scores) <- items
# Items worded the other way round are turned before everything else
reversed <- c(@REVERSED@)
if (length(reversed) > 0) scores[, reversed] <- @TURN@ - scores[, reversed]
kept <- setdiff(items, dropped)
usable <- if ("@MISSING@" == "listwise") complete.cases(scores[, kept]) else rowSums(!is.na(scores[, kept])) > 0
x <- scores[usable, kept]

# Means, and correlations of all items (the paper's Fig. 6)
print(describe(scores)[, c("n", "mean", "sd")])
way <- if ("@MISSING@" == "listwise") "complete" else "pairwise"
all_items <- corr.test(scores, use = way, adjust = "none", ci = FALSE)
print(round(all_items$r, 3))

# KMO and Bartlett
r <- if ("@METHOD@" == "polychoric") polychoric(x, correct = 0, global = FALSE)$rho else
  if ("@MISSING@" == "fiml") corFiml(x) else cor(x, use = "pairwise")
n <- if ("@MISSING@" == "listwise") nrow(x) else min(pairwiseCount(x))
kmo <- KMO(r)
bartlett <- cortest.bartlett(r, n = n)
cat(sprintf("KMO %.3f   Bartlett chi2(%d) = %.2f, p = %.3g\n",
  kmo$MSA, as.integer(bartlett$df), bartlett$chisq, bartlett$p.value))

# Components (Table 2) and their rotation (Table 3); psych stops its varimax early, so GPArotation to the end
values <- eigen(r)$values
keep <- @KEEP@
unrotated <- unclass(principal(r, nfactors = keep, rotate = "none")$loadings)
turn <- function(start) suppressWarnings(switch("@ROTATION@",
  varimax = Varimax(unrotated, Tmat = start, normalize = TRUE, eps = 1e-8, maxit = 5000),
  oblimin = GPFoblq(unrotated, Tmat = start, method = "quartimin", normalize = TRUE, eps = 1e-8, maxit = 5000)))
loadings <- unrotated
if ("@ROTATION@" != "none" && keep > 1) {
  set.seed(1)
  ends <- lapply(0:8, function(at) turn(if (at == 0) diag(keep) else Random.Start(keep)))
  loadings <- unclass(ends[[which.min(sapply(ends, function(end) min(end$Table[, 2])))]]$loadings)
  loadings <- loadings %*% diag(ifelse(colSums(loadings) < 0, -1, 1), keep)
  rownames(loadings) <- kept
  if ("@ROTATION@" == "varimax") loadings <- loadings[, order(-colSums(loadings^2)), drop = FALSE]
}
print(round(data.frame(initial = values, percent = 100 * values / length(values)), 3))
print(round(loadings, 3))

# Reliability, and how many components chance would keep
reliable <- suppressWarnings(alpha(as.data.frame(x), check.keys = FALSE))
cat(sprintf("Cronbach's alpha %.3f\n", reliable$total$raw_alpha))

# Scale by scale: the items of each component, then of each module. McDonald's omega is that of one factor by maximum
# likelihood, common variance over that of the model; psych's omega() takes standardised items and minres instead.
omega_of <- function(items) {
  if (length(items) < 3) return(NA)
  part <- r[items, items]
  one <- tryCatch(factanal(covmat = part, factors = 1, n.obs = n, control = list(nstart = 5, opt = list(factr = 1e3))),
                  error = function(e) NULL)
  if (is.null(one)) return(NA)
  spread <- apply(x[, items], 2, sd, na.rm = TRUE)
  common <- sum(one$loadings[, 1] * spread)^2
  common / (common + sum(one$uniquenesses * spread^2))
}
home <- max.col(abs(loadings), ties.method = "first")
scales <- lapply(seq_len(keep), function(at) kept[home == at])
names(scales) <- paste0("component_", seq_len(keep))
scales <- c(scales, lapply(list(@SCALES@), intersect, kept))
reliabilities <- list()
for (name in names(scales)) {
  items_here <- scales[[name]]
  if (length(items_here) < 2) next
  one <- suppressWarnings(alpha(as.data.frame(x[, items_here]), check.keys = FALSE, use = "pairwise"))
  omega_here <- omega_of(items_here)
  cat(sprintf("\n%s: alpha %.3f, omega %.3f\n", name, one$total$raw_alpha, omega_here))
  print(round(data.frame(item_total = one$item.stats$r.drop,
    alpha_without = if (length(items_here) > 2) one$alpha.drop$raw_alpha else NA, row.names = items_here), 3))
  reliabilities[[name]] <- list(items = items_here, alpha = one$total$raw_alpha, omega = omega_here,
    item_total = one$item.stats$r.drop)
}
chance <- fa.parallel(r, n.obs = n, fa = "pc", n.iter = 100, quant = .95, plot = FALSE)

if (length(given) > 1)
  writeLines(jsonlite::toJSON(list(n = n, kmo = kmo$MSA, chi2 = bartlett$chisq, eigenvalues = values,
    alpha = reliable$total$raw_alpha, items = kept, loadings = unname(loadings), scales = reliabilities),
    digits = NA, auto_unbox = TRUE), given[2])
"""


@dataclass(frozen=True)
class Replication:
    """What the script is to repeat, as `survey analyse` takes it.

    file: the CSV that it reads by default; name: its own. turn: lowest + highest point, what a reversed score is taken
    from. scales: name → items stated to belong together.
    """

    items: Sequence[str]
    file: str = "answers.csv"
    name: str = "analysis.R"
    dropped: Sequence[str] = ()
    rotation: str = "varimax"
    factors: int | str = "kaiser"
    missing: str = "listwise"
    method: str = "pearson"
    reverse: Sequence[str] = ()
    turn: float = 0.0
    scales: Mapping[str, Sequence[str]] = field(default_factory=dict)


def write_r(wanted: Replication) -> str:
    """The script's text."""
    if isinstance(wanted.factors, int):
        keep = str(wanted.factors)
    elif wanted.factors == "kaiser":
        keep = "sum(values > 1)"
    else:
        keep = 'max(1, fa.parallel(r, n.obs = n, fa = "pc", quant = .95, plot = FALSE)$ncomp)'
    scales = [f"{_strings([name])} = c({_strings(items)})" for name, items in wanted.scales.items()]
    filled = {
        "NAME": wanted.name, "FILE": wanted.file, "ITEMS": _strings(wanted.items),
        "GUARDED": _strings(map(safe_cell, wanted.items)), "DROPPED": _strings(wanted.dropped),
        "MISSING": wanted.missing, "METHOD": wanted.method, "ROTATION": wanted.rotation, "KEEP": keep,
        "REVERSED": _strings(wanted.reverse), "TURN": f"{wanted.turn:.17g}", "SCALES": ", ".join(scales),
    }  # fmt: skip
    # All at once: a column's name that looks like one of our marks stays as it is.
    return re.sub(r"@([A-Z]+)@", lambda mark: filled[mark[1]], _SCRIPT)


def _strings(texts: Iterable[str]) -> str:
    # JSON's escapes are R's, for any column name.
    return ", ".join(json.dumps(text, ensure_ascii=False) for text in texts)
