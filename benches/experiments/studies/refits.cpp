// W4's scene with sites that move: the plain loop that one writes. Eigen's fixed sizes, one fit a replicate.
//
//     refits REPLICATES     prints fits a second, mean and sd of S, mean and sd of R
#include <Eigen/Dense>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

constexpr int N = 36, U = 9;
constexpr double LO = -4.5, HI = 4.5, RADIUS = 6.6, NOISE = 0.05, ROOTS[3] = {1, 2, 2};

static void bernstein(double x, double b[3], double d[3]) {
    const double u = (x - LO) / (HI - LO), v = 1 - u, s = 2 / (HI - LO);
    b[0] = v * v, b[1] = 2 * u * v, b[2] = u * u;
    d[0] = -s * v, d[1] = s * (v - u), d[2] = s * u;
}

int main(int, char **arguments) {
    const int count = std::atoi(arguments[1]);
    const double pi = std::acos(-1.0), sine = std::sin(pi / 6), cosine = std::cos(pi / 6);
    double sites[N][5];
    for (int r = 0; r < N; ++r) {
        const double x = 4.0 * (r / 12) - 4, y = -4 + 1.6 * (r % 12 / 2), across = -x * sine + y * cosine;
        const double depth = std::sqrt(RADIUS * RADIUS - across * across);
        const double own[5] = {x, y, depth - RADIUS, across / depth * sine, -across / depth * cosine};
        for (int k = 0; k < 5; ++k) sites[r][k] = own[k];
    }
    std::mt19937_64 generator(2026);
    std::normal_distribution<double> normal(0, NOISE);
    double sums[4] = {};
    const auto start = std::chrono::steady_clock::now();
    for (int replicate = 0; replicate < count; ++replicate) {
        Eigen::Matrix<double, 3 * N, U> rows;
        Eigen::Matrix<double, 3 * N, 1> right;
        for (int r = 0; r < N; ++r) {
            double bx[3], dx[3], by[3], dy[3];
            bernstein(sites[r][0] + normal(generator), bx, dx);
            bernstein(sites[r][1] + normal(generator), by, dy);
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j) {
                    rows(r, 3 * i + j) = ROOTS[0] * bx[i] * by[j];
                    rows(N + r, 3 * i + j) = ROOTS[1] * dx[i] * by[j];
                    rows(2 * N + r, 3 * i + j) = ROOTS[2] * bx[i] * dy[j];
                }
            right(r) = ROOTS[0] * (sites[r][2] + normal(generator));
            right(N + r) = ROOTS[1] * sites[r][3];
            right(2 * N + r) = ROOTS[2] * sites[r][4];
        }
        Eigen::Matrix<double, U, U> matrix = rows.transpose() * rows;
        const Eigen::Matrix<double, U, 1> c = matrix.llt().solve(rows.transpose() * right);
        double s = 0, curved = 0;
        for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b) {
                double bx[3], dx[3], by[3], dy[3];
                bernstein(-3.5 + a, bx, dx);
                bernstein(-3.5 + b, by, dy);
                const double h = 2 / ((HI - LO) * (HI - LO)), dd[3] = {h, -2 * h, h};
                double p = 0, q = 0, xx = 0, xy = 0, yy = 0;
                for (int i = 0; i < 3; ++i)
                    for (int j = 0; j < 3; ++j) {
                        const double own = c(3 * i + j);
                        p += own * dx[i] * by[j], q += own * bx[i] * dy[j];
                        xx += own * dd[i] * by[j], xy += own * dx[i] * dy[j], yy += own * bx[i] * dd[j];
                    }
                const double g = 1 + p * p + q * q, gauss = (xx * yy - xy * xy) / (g * g);
                const double mean = ((1 + q * q) * xx - 2 * p * q * xy + (1 + p * p) * yy) / (2 * g * std::sqrt(g));
                s += -2 / pi * std::atan2(mean, std::sqrt(std::fmax(mean * mean - gauss, 0))) / 64;
                curved += std::sqrt(std::fmax(2 * mean * mean - gauss, 0)) / 64;
            }
        sums[0] += s, sums[1] += s * s, sums[2] += curved, sums[3] += curved * curved;
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const double n = count, s = sums[0] / n, r = sums[2] / n;
    std::printf("%.1f %.6f %.6f %.6f %.6f\n", n / seconds, s, std::sqrt(sums[1] / n - s * s), r, std::sqrt(sums[3] / n - r * r));
}
