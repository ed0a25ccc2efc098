# What R's lavaan says of measurement models, as JSON; run by bench_survey_lavaan.py.
#   Rscript survey_lavaan.R FOLDER OUT.json      our FOLDER/likert-200.csv and FOLDER/likert-200-gaps.csv, and lavaan's
#                                                HolzingerSwineford1939, whose rows it writes beside them
# Of Holzinger and Swineford's answers only sums go into OUT.json: counts, means and covariances of those who have the
# same items; of the cut ones the tables of all pairs, thresholds, polychoric correlations and their errors' covariance.
suppressMessages({library(lavaan); library(jsonlite)})
options(warn = 1)
given <- commandArgs(trailingOnly = TRUE)
folder <- given[1]

school <- "visual =~ x1 + x2 + x3\ntextual =~ x4 + x5 + x6\nspeed =~ x7 + x8 + x9"
school_more <- paste(school, "\nvisual =~ x9\nx2 ~~ x7")
one <- "speed =~ x7 + x8 + x9 + x1"
garment <- paste("fabric =~ fabric_texture + fabric_colour + fabric_lustre + thickness_texture",
  "form =~ silhouette + detail_structure + pleat + perspective", "dynamic =~ dynamic_drape + dynamic_swing", sep = "\n")

measures <- c("chisq", "df", "pvalue", "baseline.chisq", "baseline.df", "cfi", "tli", "rmsea", "rmsea.ci.lower",
  "rmsea.ci.upper", "rmsea.pvalue", "srmr")
scaled <- c("chisq.scaled", "df.scaled", "pvalue.scaled", "chisq.scaling.factor", "baseline.chisq.scaled", "cfi.scaled",
  "tli.scaled", "rmsea.scaled", "rmsea.ci.lower.scaled", "rmsea.ci.upper.scaled", "rmsea.pvalue.scaled")

told <- function(model, data, ...) {
  fit <- cfa(model, data = data, ...)
  robust <- lavInspect(fit, "options")$estimator == "DWLS" && length(fit@test) > 1
  figures <- fitMeasures(fit)
  out <- list(
    model = model, n = lavInspect(fit, "nobs"), fit = as.list(unclass(figures[measures])),
    estimates = parameterEstimates(fit, ci = FALSE, zstat = FALSE, pvalue = FALSE,
      remove.system.eq = TRUE)[, c("lhs", "op", "rhs", "est", "se")],
    standardised = standardizedSolution(fit, ci = FALSE, zstat = FALSE, pvalue = FALSE)[, c("lhs", "op", "rhs", "est.std", "se")])
  if (robust) {
    out$robust <- as.list(unclass(figures[scaled]))
    out$shift <- fit@test[[2]]$shift.parameter
  } else {
    hints <- modindices(fit, sort. = TRUE, maximum.number = 10)
    out$hints <- hints[hints$op != "~1", c("lhs", "op", "rhs", "mi", "epc")]
  }
  out
}

moments <- function(data) {  # sums of the answers that have the same items
  x <- as.matrix(data)
  which <- apply(!is.na(x), 1, function(row) paste(as.integer(row), collapse = ""))
  lapply(unname(split(seq_len(nrow(x)), which)), function(rows) {
    there <- !is.na(x[rows[1], ])
    part <- x[rows, there, drop = FALSE]
    list(items = colnames(x)[there], n = length(rows), mean = unname(colMeans(part)),
      covariance = unname(cov(part) * (length(rows) - 1) / length(rows)))
  })
}

ordinal <- function(model, data, sums = NULL) {
  data[] <- lapply(data, ordered)
  fit <- cfa(model, data = data, estimator = "WLSMV")
  out <- told(model, data, estimator = "WLSMV")
  seen <- lavInspect(fit, "sampstat")
  if (is.null(sums)) return(out)
  out$thresholds <- setNames(as.list(unname(seen$th)), names(seen$th))
  out$correlations <- unname(unclass(seen$cov))
  out$items <- colnames(seen$cov)
  pairs <- combn(ncol(data), 2)  # by column, as the correlations stand
  last <- length(seen$th) + seq_len(ncol(pairs))
  out$errors <- unname(lavInspect(fit, "gamma")[last, last])
  out$tables <- lapply(seq_len(ncol(pairs)), function(at)
    list(row = colnames(data)[pairs[2, at]], col = colnames(data)[pairs[1, at]],
      counts = unname(unclass(table(data[[pairs[2, at]]], data[[pairs[1, at]]])))))
  out
}

rows <- HolzingerSwineford1939[, paste0("x", 1:9)]
gaps <- rows
number <- seq_len(nrow(rows))
gaps[number %% 5 == 1, c("x2", "x5")] <- NA
gaps[number %% 5 == 2, c("x3", "x9")] <- NA
gaps[number %% 5 == 3, "x7"] <- NA
five <- as.data.frame(lapply(rows, function(x) findInterval((x - mean(x)) / sd(x), c(-1.5, -0.5, 0.5, 1.5)) + 1L))
ours <- read.csv(file.path(folder, "likert-200.csv"), fileEncoding = "UTF-8-BOM")
ours_gaps <- read.csv(file.path(folder, "likert-200-gaps.csv"), fileEncoding = "UTF-8-BOM")
for (name in c("rows", "gaps", "five"))
  write.csv(format(get(name), digits = 17, trim = TRUE), file.path(folder, paste0("school-", name, ".csv")), row.names = FALSE, quote = FALSE)

made <- list(
  made_by = "tests/bench/bench_survey_lavaan.py and tests/bench/survey_lavaan.R", R = R.version.string,
  lavaan = as.character(packageVersion("lavaan")),
  source = "Holzinger, K. J., and Swineford, F. (1939). A study in factor analysis: The stability of a bi-factor solution. University of Chicago. As lavaan's HolzingerSwineford1939 has it, x1 to x9; sums only.",
  gaps = "row i (from 1): x2 and x5 missing where i mod 5 is 1, x3 and x9 where it is 2, x7 where it is 3",
  five = "z = (x - mean) / sd (divisor n - 1), cut at -1.5, -0.5, 0.5, 1.5; a value on a cut belongs above it",
  fits = list(
    school = c(told(school, rows), list(moments = moments(rows))),
    school_more = told(school_more, rows),
    school_one = told(one, rows),
    school_gaps = c(told(school, gaps, missing = "ml"), list(moments = moments(gaps))),
    school_five = ordinal(school, five, sums = TRUE),
    likert = told(garment, ours),
    likert_gaps = told(garment, ours_gaps, missing = "ml"),
    likert_ordinal = ordinal(garment, ours)))
writeLines(toJSON(made, digits = NA, auto_unbox = TRUE, null = "null", na = "null"), given[2])
