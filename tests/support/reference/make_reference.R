# Reference cases for surmount.stats, computed by R. The tests read the JSON files and need no R.
#
#   Rscript tests/stats/reference/make_reference.R        (run at the root of the repository)
#
# Debian 12: r-base-core r-cran-survival r-cran-lme4 r-cran-lmertest r-cran-emmeans r-cran-pbkrtest
# r-cran-jsonlite (numDeriv comes with lmerTest). Data are drawn here with fixed seeds and rounded, so that the JSON holds exactly
# the numbers that R used; results are written with 15 significant digits.

suppressMessages({
  library(survival)
  library(lme4)
  library(lmerTest)
  library(emmeans)
  library(pbkrtest)
  library(jsonlite)
})

folder <- "tests/stats/reference"
versions <- c(
  R = paste(R.version$major, R.version$minor, sep = "."),
  sapply(c("survival", "lme4", "lmerTest", "emmeans", "pbkrtest"),
         function(name) as.character(packageVersion(name)))
)
write_cases <- function(cases, file) {
  write_json(list(versions = as.list(versions), cases = cases), file.path(folder, file),
             digits = NA, auto_unbox = TRUE, na = "null", null = "null", pretty = TRUE)
}
# jsonlite writes a vector of length one as a scalar when unboxing; I() keeps it a list.
vec <- function(x) I(unname(x))

# ---------------------------------------------------------------- proportions
proportion_case <- function(successes, totals, confidence = 0.95) {
  test <- suppressWarnings(prop.test(successes, totals, conf.level = confidence))
  wilson <- lapply(1:2, function(i) suppressWarnings(
    prop.test(successes[i], totals[i], correct = FALSE, conf.level = confidence)$conf.int))
  list(successes = successes, totals = totals, confidence = confidence,
       statistic = unname(test$statistic), p_value = test$p.value,
       proportions = unname(test$estimate), lower = test$conf.int[1], upper = test$conf.int[2],
       wilson_lower = c(wilson[[1]][1], wilson[[2]][1]),
       wilson_upper = c(wilson[[1]][2], wilson[[2]][2]))
}
proportions <- list(
  paper_step_difficult = proportion_case(c(239, 1), c(240, 240)),
  paper_step_medium = proportion_case(c(779, 244), c(780, 780)),
  paper_entrance_difficult = proportion_case(c(540, 512), c(540, 540)),
  ordinary = proportion_case(c(45, 56), c(100, 90)),
  equal_rates = proportion_case(c(30, 60), c(50, 100)),
  correction_shrunk_by_a_small_difference = proportion_case(c(50, 51), c(100, 101)),
  nearly_all = proportion_case(c(899, 900), c(900, 900)),
  nearly_none = proportion_case(c(0, 1), c(900, 900)),
  opposite_extremes = proportion_case(c(30, 0), c(30, 30)),
  tiny_samples = proportion_case(c(2, 1), c(3, 4)),
  one_trial_each = proportion_case(c(1, 0), c(1, 1)),
  unequal_arms = proportion_case(c(7, 1500), c(12, 1800)),
  confidence_99 = proportion_case(c(83, 64), c(120, 115), confidence = 0.99),
  large = proportion_case(c(51234, 49876), c(100000, 100000))
)
write_cases(proportions, "proportions.json")

# ---------------------------------------------------------------- survival
curve <- function(time, event, confidence) {
  fit <- survfit(Surv(time, event) ~ 1, conf.int = confidence)
  # The median that survfit prints. (quantile() differs from it where a curve ends on one half.)
  median <- summary(fit)$table[7:9]
  error <- fit$std.err
  error[!is.finite(error)] <- NA
  list(time = vec(fit$time), at_risk = vec(fit$n.risk), events = vec(fit$n.event),
       censored = vec(fit$n.censor), survival = vec(fit$surv), log_std_error = vec(error),
       lower = vec(fit$lower), upper = vec(fit$upper), median = unname(median[1]),
       median_lower = unname(median[2]), median_upper = unname(median[3]))
}
survival_case <- function(time, event, group, confidence = 0.95) {
  test <- survdiff(Surv(time, event) ~ group)
  labels <- sort(unique(group))
  curves <- lapply(labels, function(g) curve(time[group == g], event[group == g], confidence))
  names(curves) <- labels
  list(time = time, event = event, group = group, confidence = confidence, labels = labels,
       n = unname(as.integer(test$n)), observed = unname(test$obs), expected = unname(test$exp),
       statistic = test$chisq, degrees_of_freedom = sum(test$exp > 0) - 1,
       p_value = pchisq(test$chisq, sum(test$exp > 0) - 1, lower.tail = FALSE), curves = curves)
}
completion <- function(n, rate, cap, digits) {
  time <- round(rexp(n, rate) + 2, digits)
  list(time = pmin(time, cap), event = as.integer(time < cap))
}
two_arms <- function(seed, n, rates, cap, digits, ...) {
  set.seed(seed)
  parts <- lapply(rates, function(rate) completion(n, rate, cap, digits))
  survival_case(unlist(lapply(parts, `[[`, "time")), unlist(lapply(parts, `[[`, "event")),
                rep(letters[seq_along(rates)], each = n), ...)
}
aml <- survival::aml
survivals <- list(
  aml = survival_case(aml$time, aml$status, ifelse(aml$x == "Maintained", "a", "b")),
  aml_90 = survival_case(aml$time, aml$status, ifelse(aml$x == "Maintained", "a", "b"), 0.90),
  without_ties = two_arms(1, 40, c(0.3, 0.2), 20, 5),
  many_ties = two_arms(2, 120, c(0.3, 0.2), 20, 0),
  heavy_censoring = two_arms(3, 60, c(0.02, 0.004), 20, 1),
  three_groups = two_arms(4, 50, c(0.4, 0.2, 0.1), 20, 1),
  no_censoring = two_arms(5, 30, c(0.5, 0.4), 1000, 2),
  one_arm_always_fails = survival_case(c(3.1, 4, 4, 5.5, 6, 20, 20, 20, 20, 20),
                                       c(1, 1, 1, 1, 1, 0, 0, 0, 0, 0), rep(c("a", "b"), each = 5)),
  median_on_a_flat_step = survival_case(c(1, 2, 3, 4, 1, 2, 3, 4), c(1, 1, 1, 1, 1, 1, 0, 0),
                                        rep(c("a", "b"), each = 4)),
  censored_before_the_last_event = survival_case(c(2, 3, 3, 5, 7, 8, 1, 3, 4, 4, 6, 9),
                                                 c(1, 1, 0, 1, 0, 1, 0, 1, 1, 0, 1, 1),
                                                 rep(c("a", "b"), each = 6)),
  # 0.1 added up thirty times is not 3: both sides must count these as one time.
  rounding_ties = survival_case(c(cumsum(rep(0.1, 60))[seq(2, 60, 2)], seq(1, 60, 2) / 10, seq(2, 60, 2) / 10),
                                rep(c(1, 1, 0), 30), rep(c("a", "b", "b"), each = 30)),
  time_zero = survival_case(c(0, 0, 1, 2, 0, 3, 4, 5), c(1, 0, 1, 1, 0, 1, 1, 0),
                            rep(c("a", "b"), each = 4))
)
write_cases(survivals, "survival.json")

# ---------------------------------------------------------------- mixed models
# lmer's default optimiser stops at 1e-8 in the deviance, and any optimiser that compares deviances
# is lost in their rounding once theta is within about 1e-7 of the optimum. Six-digit references need
# more: the root of the derivative of lme4's own deviance function. lmer then takes that theta as is.
optimal_theta <- function(formula, data) {
  deviance <- suppressMessages(lme4::lmer(formula, data, REML = TRUE, devFunOnly = TRUE))
  coarse <- optimize(function(x) deviance(exp(x)), c(-12, 12), tol = 1e-8)$minimum
  for (low in seq(-12, 12, 0.5)) {  # a second optimum must not go unnoticed
    if (deviance(exp(low)) < deviance(exp(coarse)) - 1e-6) stop("missed the optimum")
  }
  if (deviance(0) <= deviance(exp(coarse))) return(0)
  slope <- function(x) numDeriv::grad(function(l) deviance(exp(l)), x)
  exp(uniroot(slope, coarse + c(-0.1, 0.1), tol = 1e-14)$root)
}
fit_exactly <- function(lmer, formula, data) {
  control <- lmerControl(optimizer = NULL, check.conv.singular = "ignore",
                         check.conv.grad = "ignore", check.conv.hess = "ignore")
  theta <- optimal_theta(formula, data)
  suppressMessages(eval(bquote(
    lmer(.(formula), data, REML = TRUE, control = control, start = list(theta = .(theta))))))
}

summarise <- function(model, data, form, ddf, confidence) {
  means <- as.data.frame(summary(emmeans(model, form, data = data, lmer.df = ddf, level = confidence),
                                 infer = c(TRUE, FALSE)))
  contrasts <- as.data.frame(summary(
    emmeans(model, form, data = data, lmer.df = ddf, level = confidence,
            contr = "pairwise")$contrasts,
    infer = c(TRUE, TRUE), adjust = "none"))
  column <- function(frame, name) if (name %in% names(frame)) vec(as.character(frame[[name]])) else NULL
  list(
    means = list(group = column(means, "group"), method = column(means, "method"),
                 estimate = vec(means$emmean), std_error = vec(means$SE), df = vec(means$df),
                 lower = vec(means$lower.CL), upper = vec(means$upper.CL)),
    contrasts = list(group = column(contrasts, "group"), pair = column(contrasts, "contrast"),
                     estimate = vec(contrasts$estimate), std_error = vec(contrasts$SE),
                     df = vec(contrasts$df), t = vec(contrasts$t.ratio),
                     p_value = vec(contrasts$p.value), lower = vec(contrasts$lower.CL),
                     upper = vec(contrasts$upper.CL)))
}
mixed_case <- function(data, confidence = 0.95) {
  data$group <- factor(data$group)
  data$method <- factor(data$method)
  data$network <- factor(data$network)
  crossed <- nlevels(data$group) > 1
  form <- if (crossed) pairwise ~ method | group else pairwise ~ method
  form <- update(form, NULL ~ .)
  fixed <- if (crossed) y ~ group * method + (1 | network) else y ~ method + (1 | network)
  # lmerTest::lmer holds the Hessian that Satterthwaite's rule needs.
  model <- fit_exactly(lmerTest::lmer, fixed, data)
  interaction <- NULL
  if (crossed) {
    additive <- fit_exactly(lme4::lmer, y ~ group + method + (1 | network), data)
    full <- fit_exactly(lme4::lmer, fixed, data)
    kr <- KRmodcomp(full, additive)$test
    keep <- grep(":", names(fixef(model)))
    L <- diag(length(fixef(model)))[keep, , drop = FALSE]
    sat <- lmerTest::contestMD(model, L, ddf = "Satterthwaite")
    interaction <- list(
      kenward_roger = list(statistic = kr["Ftest", "stat"], numerator_df = kr["Ftest", "ndf"],
                           denominator_df = kr["Ftest", "ddf"], p_value = kr["Ftest", "p.value"]),
      satterthwaite = list(statistic = sat[["F value"]], numerator_df = sat[["NumDF"]],
                           denominator_df = sat[["DenDF"]], p_value = sat[["Pr(>F)"]]))
  }
  components <- as.data.frame(VarCorr(model))$vcov
  list(table = list(y = data$y, group = as.character(data$group),
                    method = as.character(data$method), network = as.character(data$network)),
       confidence = confidence, reml_criterion = unname(REMLcrit(model)),
       subject_variance = components[1], residual_variance = components[2],
       singular = isSingular(model), interaction = interaction,
       kenward_roger = summarise(model, data, form, "kenward-roger", confidence),
       satterthwaite = summarise(model, data, form, "satterthwaite", confidence))
}
design <- function(seed, groups, methods, networks, repetitions, network_sd, residual_sd = 10) {
  set.seed(seed)
  data <- expand.grid(repetition = seq_len(repetitions), group = groups, method = methods,
                      network = paste0("n", seq_len(networks)), stringsAsFactors = FALSE)
  offset <- setNames(rnorm(networks, 0, network_sd), unique(data$network))
  mean <- 100 + 15 * as.integer(factor(data$group)) + 8 * as.integer(factor(data$method)) +
    6 * (data$group == groups[1]) * (data$method == methods[1])
  data$y <- round(mean + offset[data$network] + rnorm(nrow(data), 0, residual_sd), 4)
  data
}
drop_rows <- function(data, seed, share) {
  set.seed(seed)
  data[sort(sample(nrow(data), round(nrow(data) * (1 - share)))), ]
}
arms <- c("control", "curriculum")
# Without any network effect: residuals that sum to the same in every network and cell.
singular <- design(15, c("easy", "difficult"), arms, 4, 6, 0)
singular$y <- singular$y - ave(singular$y, singular$network, singular$group, singular$method) +
  ave(singular$y, singular$group, singular$method)
singular$y <- round(singular$y, 4)
unequal <- design(22, c("easy", "medium", "difficult"), arms, 6, 8, 12)
unequal <- unequal[!(unequal$method == "control" & unequal$network %in% c("n1", "n2")), ]
hole <- design(23, c("easy", "medium", "difficult"), arms, 5, 6, 7)
hole <- hole[!(hole$method == "control" & hole$group == "difficult"), ]
mixed <- list(
  balanced = mixed_case(design(11, c("easy", "difficult"), arms, 5, 6, 8)),
  balanced_99 = mixed_case(design(11, c("easy", "difficult"), arms, 5, 6, 8), 0.99),
  unbalanced = mixed_case(drop_rows(design(12, c("easy", "medium", "difficult"), arms, 6, 8, 6), 1, 0.4)),
  strongly_unbalanced = mixed_case(drop_rows(design(13, c("easy", "medium", "difficult"), arms, 10, 3, 15), 2, 0.45)),
  large_network_effect = mixed_case(drop_rows(design(14, c("easy", "difficult"), arms, 5, 6, 60, 4), 3, 0.2)),
  small_network_effect = mixed_case(drop_rows(design(31, c("easy", "difficult"), arms, 8, 8, 2.5), 4, 0.2)),
  singular_balanced = mixed_case(singular),
  singular_unbalanced = mixed_case(drop_rows(singular, 5, 0.35)),
  two_networks = mixed_case(drop_rows(design(17, c("easy", "medium", "difficult"), arms, 2, 12, 10), 6, 0.3)),
  one_group = mixed_case(drop_rows(design(18, c("all"), arms, 6, 8, 6), 7, 0.3)),
  three_methods = mixed_case(drop_rows(design(19, c("easy", "difficult"), c("control", "curriculum", "uniform"), 5, 5, 9), 8, 0.3)),
  methods_partly_in_different_networks = mixed_case(unequal),
  empty_cell = mixed_case(hole)
)
write_cases(mixed, "mixed.json")

# ---------------------------------------------------------------- evidence over seeds
set.seed(41)
scores <- function(n) round(pmin(1, pmax(0, rnorm(n, 0.8, 0.2))), 3)
win <- function(x, y) unname(suppressWarnings(wilcox.test(x, y))$statistic) / (length(x) * length(y))
evidence <- lapply(list(small = c(4, 5), odd = c(7, 7), large = c(50, 41)), function(n) {
  x <- scores(n[1])
  y <- scores(n[2])
  list(first = x, second = y, trimmed_first = mean(x, trim = 0.25),
       trimmed_second = mean(y, trim = 0.25), first_wins = win(x, y))
})
write_cases(evidence, "evidence.json")
