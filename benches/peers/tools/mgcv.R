# mgcv: a tensor-product smooth of the heights, its smoothness by REML, derivatives by differences of its predictions.
# P-splines with a penalty on third differences: the default basis of te has no second derivative at the edges. The first number of m
# is the degree less one, so that these are splines of degree 4 over BASIS - 4 cells a direction; DEGREE 3 takes cubic ones instead.
#
#     Rscript mgcv.R CONTACTS.csv TARGETS.csv BASIS REPETITIONS [DEGREE]    prints "T seconds", then zx, zy, zxx, zxy, zyy a line
suppressMessages(library(mgcv))
arguments <- commandArgs(trailingOnly = TRUE)
touched <- read.csv(arguments[1])
target <- read.csv(arguments[2])
basis <- as.integer(arguments[3])
cubic <- identical(arguments[5], "3")
h <- 1e-2
for (repetition in seq_len(as.integer(arguments[4]))) {
    start <- proc.time()[["elapsed"]]
    smooth <- z ~ te(x, y, bs = "ps", m = c(3, 3), k = basis)
    if (cubic) smooth <- z ~ te(x, y, bs = "ps", m = c(2, 3), k = basis)
    if (nrow(touched) < 5000) {
        fit <- gam(smooth, data = touched, method = "REML")
    } else {
        fit <- bam(smooth, data = touched, discrete = TRUE)
    }
    at <- function(dx, dy) predict(fit, data.frame(x = target$x + dx, y = target$y + dy))
    zx <- (at(h, 0) - at(-h, 0)) / (2 * h)
    zy <- (at(0, h) - at(0, -h)) / (2 * h)
    zxx <- (at(h, 0) - 2 * at(0, 0) + at(-h, 0)) / h^2
    zyy <- (at(0, h) - 2 * at(0, 0) + at(0, -h)) / h^2
    zxy <- (at(h, h) - at(h, -h) - at(-h, h) + at(-h, -h)) / (4 * h^2)
    cat("T", proc.time()[["elapsed"]] - start, "\n")
}
write.table(cbind(zx, zy, zxx, zxy, zyy), sep = ",", row.names = FALSE, col.names = FALSE)
