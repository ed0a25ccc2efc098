# What R's psych, GPArotation and stats say of a data set, as JSON; run by bench_survey_r.py.
#   Rscript survey_psych.R FOLDER OUT.json       every FOLDER/NAME.csv, and psych's bfi and datasets' attitude
suppressMessages({library(psych); library(GPArotation); library(jsonlite)})
options(warn = 1)
given <- commandArgs(trailingOnly = TRUE)
data_sets <- list()
for (path in sort(list.files(given[1], pattern = "[.]csv$", full.names = TRUE)))
  data_sets[[sub("[.]csv$", "", basename(path))]] <- as.matrix(read.csv(path))
data("bfi", package = "psych", envir = environment())
items <- as.matrix(bfi[, 1:25])
data_sets[["psych-bfi"]] <- items[complete.cases(items), ]
data_sets[["attitude"]] <- as.matrix(attitude)

# The five scales of bfi with their keys, as psych's help page of bfi states them; a minus: worded the other way round.
keys <- list(A = c("-A1", "A2", "A3", "A4", "A5"), C = c("C1", "C2", "C3", "-C4", "-C5"),
  E = c("-E1", "-E2", "E3", "E4", "E5"), N = c("N1", "N2", "N3", "N4", "N5"), O = c("O1", "-O2", "O3", "O4", "-O5"))

scale_told <- function(key) {
  items <- sub("^-", "", key)
  part <- data_sets[["psych-bfi"]][, items]
  turned <- startsWith(key, "-")
  part[, turned] <- 7 - part[, turned]
  reliable <- suppressWarnings(alpha(as.data.frame(part), check.keys = FALSE, n.iter = 1))
  total <- function(fm) suppressMessages(suppressWarnings(omega(cor(part), nfactors = 1, fm = fm, n.obs = nrow(part), plot = FALSE)$omega.tot))
  one <- factanal(covmat = cor(part), factors = 1, n.obs = nrow(part), control = list(nstart = 5, lower = 0.005, opt = list(factr = 1e3, maxit = 5000)))
  spread <- apply(part, 2, sd)
  common <- sum(one$loadings[, 1] * spread)^2
  list(items = items, reversed = I(items[turned]), n = nrow(part), alpha = reliable$total$raw_alpha,
    standardised = reliable$total$std.alpha, if_deleted = reliable$alpha.drop$raw_alpha,
    item_total = reliable$item.stats$r.drop, omega = common / (common + sum(one$uniquenesses * spread^2)),
    omega_total_ml = total("ml"), omega_total_minres = total("minres"))
}

best_varimax <- function(loadings) {  # psych and stats stop early; GPArotation to its end, from several starts
  set.seed(1)
  best <- NULL
  for (start in 0:8) {
    turn <- if (start == 0) diag(ncol(loadings)) else Random.Start(ncol(loadings))
    found <- suppressWarnings(Varimax(loadings, Tmat = turn, normalize = TRUE, eps = 1e-8, maxit = 2000))
    value <- min(found$Table[, 2])
    if (is.null(best) || value < best$value) best <- list(value = value, loadings = unclass(found$loadings))
  }
  best$loadings
}

best_oblimin <- function(loadings) {
  set.seed(1)
  best <- NULL
  for (start in 0:3) {
    turn <- if (start == 0) diag(ncol(loadings)) else Random.Start(ncol(loadings))
    found <- suppressWarnings(
      GPFoblq(loadings, Tmat = turn, method = "quartimin", normalize = TRUE, eps = 1e-8, maxit = 2000))
    value <- min(found$Table[, 2])
    if (is.null(best) || value < best$value)
      best <- list(value = value, loadings = unclass(found$loadings), phi = found$Phi)
  }
  list(loadings = best$loadings, phi = best$phi)
}

told <- function(x) {
  n <- nrow(x); p <- ncol(x)
  message("data set of ", n, " x ", p)
  tested <- corr.test(x, adjust = "none", ci = FALSE)
  r <- tested$r
  kmo <- KMO(r)
  bartlett <- cortest.bartlett(r, n = n)
  reliable <- suppressWarnings(alpha(as.data.frame(x), check.keys = FALSE, n.iter = 1))
  k <- max(2, sum(eigen(r)$values > 1))
  unrotated <- unclass(principal(r, nfactors = k, rotate = "none")$loadings)
  one <- factanal(covmat = r, factors = 1, n.obs = n, control = list(nstart = 5, lower = 0.005, opt = list(factr = 1e3, maxit = 5000)))
  spread <- apply(x, 2, sd)
  common <- sum(one$loadings[, 1] * spread)^2
  few <- all(x == round(x)) && max(apply(x, 2, function(column) length(unique(column)))) <= 8
  set.seed(1)
  chance <- fa.parallel(x, fa = "pc", n.iter = 200, quant = 0.95, plot = FALSE, sim = TRUE)
  list(
    n = n, p = p, names = colnames(x), covariance = unname(cov(x)), r = unname(r), probability = unname(tested$p),
    kmo = kmo$MSA, kmo_per_item = unname(kmo$MSAi), chi2 = bartlett$chisq, df = bartlett$df, bartlett_p = bartlett$p.value,
    eigenvalues = eigen(r)$values, alpha = reliable$total$raw_alpha, alpha_standardised = reliable$total$std.alpha,
    alpha_if_deleted = if (p > 2) reliable$alpha.drop$raw_alpha else NULL,
    map = vss(r, n = min(8, p - 1), n.obs = n, plot = FALSE)$map,
    unrotated = unname(unrotated), varimax = unname(best_varimax(unrotated)),
    varimax_psych = unname(unclass(principal(r, nfactors = k, rotate = "varimax")$loadings)),
    oblimin = lapply(best_oblimin(unrotated), unname),
    omega = common / (common + sum(one$uniquenesses * spread^2)),
    polychoric = if (few) unname(suppressWarnings(polychoric(x, correct = 0, global = FALSE)$rho)) else NULL,
    parallel_upper = chance$pc.sim)
}

sink(stderr())  # psych talks while it works
scales <- lapply(keys, scale_told)
write.csv(bfi, file.path(given[1], "bfi-whole.csv"), row.names = FALSE, na = "")  # for our command; kept nowhere
found <- lapply(data_sets, told)
sink()
made <- list(
  made_by = "tests/bench/bench_survey_r.py and tests/bench/survey_psych.R", R = R.version.string,
  psych = as.character(packageVersion("psych")), GPArotation = as.character(packageVersion("GPArotation")),
  data_sets = found, bfi_scales = scales)
writeLines(toJSON(made, digits = NA, auto_unbox = TRUE, null = "null"), given[2])
