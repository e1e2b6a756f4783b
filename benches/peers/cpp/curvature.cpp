// W5 and W4 with glibc's vector atan2, log and cos; OpenMP over rows and blocks of replicates.
//     curvature map INPUT OUTPUT REPETITIONS          67 x 67 coefficients -> S, R on 1000 x 1000 points
//     curvature noise INPUT OUTPUT REPETITIONS        W1's sites, noise-free -> six summary numbers of 100,000 replicates
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "common.hpp"

static inline void shape(int n, const double* __restrict p, const double* __restrict q, const double* __restrict xx,
                         const double* __restrict xy, const double* __restrict yy, double* __restrict s, double* __restrict r) {
#pragma omp simd
    for (int j = 0; j < n; j++) {
        double pp = p[j] * p[j], qq = q[j] * q[j], h = 1 / (1 + pp + qq);
        double gauss = (xx[j] * yy[j] - xy[j] * xy[j]) * h * h;
        double mean = 0.5 * ((1 + qq) * xx[j] - 2 * p[j] * q[j] * xy[j] + (1 + pp) * yy[j]) * h * std::sqrt(h);
        s[j] = -2 / M_PI * std::atan2(mean, std::sqrt(std::fmax(mean * mean - gauss, 0.0)));
        r[j] = std::sqrt(std::fmax(2 * mean * mean - gauss, 0.0));
    }
}

// Values, first and second derivatives of the four cubics on segment l at x.
static void cubics(const std::vector<double>& t, int l, double x, double d[3][4]) {
    double b[4][4] = {};
    b[0][0] = 1;
    for (int p = 1; p <= 3; p++) {
        double carry = 0;
        for (int i = 0; i < p; i++) {
            double hi = t[l + 1 + i], low = t[l + 1 + i - p], share = b[p - 1][i] / (hi - low);
            b[p][i] = carry + (hi - x) * share;
            carry = (x - low) * share;
        }
        b[p][p] = carry;
    }
    double slope[3] = {};
    for (int i = 0; i < 3; i++) {
        if (i > 0) slope[i] += 2 * b[1][i - 1] / (t[l + i] - t[l + i - 2]);
        if (i < 2) slope[i] -= 2 * b[1][i] / (t[l + i + 1] - t[l + i - 1]);
    }
    for (int i = 0; i < 4; i++) {
        double g = i > 0 ? 3 / (t[l + i] - t[l + i - 3]) : 0, h = i < 3 ? 3 / (t[l + i + 1] - t[l + i - 2]) : 0;
        d[0][i] = b[3][i];
        d[1][i] = (i > 0 ? g * b[2][i - 1] : 0) - (i < 3 ? h * b[2][i] : 0);
        d[2][i] = (i > 0 ? g * slope[i - 1] : 0) - (i < 3 ? h * slope[i] : 0);
    }
}

static void map(const std::vector<double>& c, std::vector<double>& out) {
    const int segments = 64, m = segments + 3, n = 1000;
    std::vector<double> t(segments + 7), d(12 * n), turned(12 * n);
    std::vector<int> first(n);
    for (int i = 0; i < segments + 7; i++) t[i] = double(std::min(std::max(i - 3, 0), segments)) / segments;
    for (int i = 0; i < n; i++) {
        double x = double(i) / (n - 1);
        first[i] = std::min(int(x * segments), segments - 1);
        cubics(t, first[i] + 3, x, (double(*)[4]) & d[12 * i]);
        for (int k = 0; k < 12; k++) turned[k * n + i] = d[12 * i + k];
    }
#pragma omp parallel
    {
        std::vector<double> curve(3 * m), row(5 * n);
#pragma omp for schedule(dynamic, 16)
        for (int i = 0; i < n; i++) {
            std::fill(curve.begin(), curve.end(), 0.0);
            for (int k = 0; k < 12; k++)
                for (int j = 0; j < m; j++) curve[k / 4 * m + j] += d[12 * i + k] * c[(first[i] + k % 4) * m + j];
            double *p = &row[0], *q = p + n, *xx = q + n, *xy = xx + n, *yy = xy + n;
            for (int from = 0, to; from < n; from = to) {
                const int o = first[from];
                for (to = from; to < n && first[to] == o;) to++;
                double a[12];
                for (int k = 0; k < 12; k++) a[k] = curve[k / 4 * m + o + k % 4];
                const double* b = turned.data();
#pragma omp simd
                for (int j = from; j < to; j++) {
                    double b0 = b[j], b1 = b[n + j], b2 = b[2 * n + j], b3 = b[3 * n + j];
                    double e0 = b[4 * n + j], e1 = b[5 * n + j], e2 = b[6 * n + j], e3 = b[7 * n + j];
                    p[j] = b0 * a[4] + b1 * a[5] + b2 * a[6] + b3 * a[7];
                    xx[j] = b0 * a[8] + b1 * a[9] + b2 * a[10] + b3 * a[11];
                    q[j] = e0 * a[0] + e1 * a[1] + e2 * a[2] + e3 * a[3];
                    xy[j] = e0 * a[4] + e1 * a[5] + e2 * a[6] + e3 * a[7];
                    yy[j] = b[8 * n + j] * a[0] + b[9 * n + j] * a[1] + b[10 * n + j] * a[2] + b[11 * n + j] * a[3];
                }
            }
            shape(n, p, q, xx, xy, yy, &out[size_t(i) * n], &out[size_t(n) * n + size_t(i) * n]);
        }
    }
}

static void quadratic(double x, double* b, double* d) {
    double inverse = 1 / 9.0, u = (x + 4.5) * inverse, v = 1 - u;
    b[0] = v * v, b[1] = 2 * u * v, b[2] = u * u;
    d[0] = -2 * inverse * v, d[1] = 2 * inverse * (v - u), d[2] = 2 * inverse * u;
}

static double percentile(std::vector<double>& v, double p) {
    double place = p * (v.size() - 1);
    size_t at = size_t(place);
    std::nth_element(v.begin(), v.begin() + at, v.end());
    double low = v[at], next = *std::min_element(v.begin() + at + 1, v.end());
    return low + (place - at) * (next - low);
}

static void noise(const std::vector<double>& in, std::vector<double>& out) {
    const int n = 100000, sites = 36, data = 108, wide = 8;
    Eigen::MatrixXd e(data, 9);
    Eigen::VectorXd b(data), factor(data);
    const double root[3] = {1, 2, 2}, sd[3] = {0.02, 0.05, 0.05};
    for (int k = 0; k < data; k++) {
        int r = k % sites, block = k / sites;
        double f[2][2][3];
        quadratic(in[r], f[0][0], f[0][1]);
        quadratic(in[sites + r], f[1][0], f[1][1]);
        for (int p = 0; p < 9; p++) e(k, p) = root[block] * f[0][block == 1][p / 3] * f[1][block == 2][p % 3];
        b[k] = root[block] * in[2 * sites + k], factor[k] = root[block] * sd[block];
    }
    Eigen::MatrixXd solve = (e.transpose() * e).llt().solve(e.transpose());
    Eigen::VectorXd nominal = solve * b;
    Eigen::MatrixXd response = solve * factor.asDiagonal();
    std::vector<double> grid(5 * 9 * 64);
    const double second[3] = {2 / 81.0, -4 / 81.0, 2 / 81.0};
    for (int k = 0; k < 64; k++) {
        double f[2][3][3];
        quadratic(-3.5 + k / 8, f[0][0], f[0][1]);
        quadratic(-3.5 + k % 8, f[1][0], f[1][1]);
        for (auto& axis : f) std::copy(second, second + 3, axis[2]);
        const int order[5][2] = {{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
        for (int d = 0; d < 5; d++)
            for (int p = 0; p < 9; p++) grid[(d * 9 + p) * 64 + k] = f[0][order[d][0]][p / 3] * f[1][order[d][1]][p % 3];
    }
    std::vector<double> s(n), r(n);
#pragma omp parallel for schedule(static)
    for (int block = 0; block < n / wide; block++) {
        alignas(64) uint64_t state[4][wide];               // xoshiro256+, a lane each, seeded by splitmix64
        uint64_t z = 2026 + 0x9E3779B97F4A7C15ull * (uint64_t(block) * 64 + 1);
        for (auto& word : state)
            for (auto& lane : word) {
                uint64_t v = (z += 0x9E3779B97F4A7C15ull);
                v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ull, v = (v ^ (v >> 27)) * 0x94D049BB133111EBull;
                lane = v ^ (v >> 31);
            }
        alignas(64) double c[9][wide], drawn[data][wide];
        for (int k = 0; k < data; k += 2) {
            alignas(64) double u[2][wide];
            for (auto& row : u)
                for (int l = 0; l < wide; l++) {
                    uint64_t v = state[0][l] + state[3][l], w = state[1][l] << 17;
                    state[2][l] ^= state[0][l], state[3][l] ^= state[1][l], state[1][l] ^= state[2][l];
                    state[0][l] ^= state[3][l], state[2][l] ^= w, state[3][l] = (state[3][l] << 45) | (state[3][l] >> 19);
                    row[l] = (double(int64_t(v >> 12)) + 0.5) * 0x1p-52;
                }
#pragma omp simd
            for (int l = 0; l < wide; l++) {
                double radius = std::sqrt(-2 * std::log(u[0][l])), angle = 2 * M_PI * u[1][l];
                drawn[k][l] = radius * std::cos(angle);
                drawn[k + 1][l] = radius * std::cos(angle - M_PI / 2);
            }
        }
        for (int p = 0; p < 9; p++) {
            double sum[wide];
            for (double& v : sum) v = nominal[p];
            for (int k = 0; k < data; k++)
                for (int l = 0; l < wide; l++) sum[l] += response(p, k) * drawn[k][l];
            std::copy(sum, sum + wide, c[p]);
        }
        for (int l = 0; l < wide; l++) {
            alignas(64) double d[5][64] = {}, index[64], curved[64];
            for (int e5 = 0; e5 < 5; e5++)
                for (int p = 0; p < 9; p++)
                    for (int j = 0; j < 64; j++) d[e5][j] += grid[(e5 * 9 + p) * 64 + j] * c[p][l];
            shape(64, d[0], d[1], d[2], d[3], d[4], index, curved);
            double sum_s = 0, sum_r = 0;
            for (int j = 0; j < 64; j++) sum_s += index[j], sum_r += curved[j];
            s[wide * block + l] = sum_s / 64, r[wide * block + l] = sum_r / 64;
        }
    }
    int at = 0;
    for (auto* v : {&s, &r}) {
        double sum = 0;
        for (double w : *v) sum += w;
        out[at++] = sum / n;
        out[at++] = percentile(*v, 0.025);
        out[at++] = percentile(*v, 0.975);
    }
}

int main(int argc, char** argv) {
    if (argc < 5) return 2;
    const bool is_map = std::string(argv[1]) == "map";
    const std::vector<double> in = read_doubles(argv[2]);
    std::vector<double> out(is_map ? 2000000 : 6);
    timed(std::atoi(argv[4]), 1, [&] { is_map ? map(in, out) : noise(in, out); });
    write_doubles(argv[3], out);
}
