// W1: fixed-size Eigen, rank-one updates of a 9 x 9 matrix, LLT, S and R on 8 x 8 points.   paper INPUT OUTPUT REPETITIONS
#include <Eigen/Dense>
#include <cmath>

#include "common.hpp"

using Matrix = Eigen::Matrix<double, 9, 9>;
using Vector = Eigen::Matrix<double, 9, 1>;
using Operator = Eigen::Matrix<double, 64, 9>;
static const double lo = -4.5, inverse = 1 / 9.0;
static Operator grid[5];

static void quadratic(double x, double* b, double* d) {
    double u = (x - lo) * inverse, v = 1 - u;
    b[0] = v * v, b[1] = 2 * u * v, b[2] = u * u;
    d[0] = -2 * inverse * v, d[1] = 2 * inverse * (v - u), d[2] = 2 * inverse * u;
}

__attribute__((noinline)) static void fit(int n, const double* in, Vector& c, double* s, double* r) {
    const double *x = in, *y = in + n, *z = in + 2 * n, *zx = in + 3 * n, *zy = in + 4 * n;
    Matrix normal = Matrix::Zero();
    Vector right = Vector::Zero();
    for (int k = 0; k < n; k++) {
        double bx[3], by[3], dx[3], dy[3];
        quadratic(x[k], bx, dx);
        quadratic(y[k], by, dy);
        Vector row[3];
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) {
                row[0][3 * p + q] = bx[p] * by[q];
                row[1][3 * p + q] = 2 * dx[p] * by[q];
                row[2][3 * p + q] = 2 * bx[p] * dy[q];
            }
        const double data[3] = {z[k], 2 * zx[k], 2 * zy[k]};
        for (int e = 0; e < 3; e++) {
            normal.noalias() += row[e] * row[e].transpose();
            right.noalias() += data[e] * row[e];
        }
    }
    c = normal.llt().solve(right);
    Eigen::Matrix<double, 64, 1> d[5];
    for (int e = 0; e < 5; e++) d[e].noalias() = grid[e] * c;
    for (int i = 0; i < 64; i++) {
        double p = d[0][i], q = d[1][i], xx = d[2][i], xy = d[3][i], yy = d[4][i], h = 1 / (1 + p * p + q * q);
        double gauss = (xx * yy - xy * xy) * h * h;
        double mean = .5 * ((1 + q * q) * xx - 2 * p * q * xy + (1 + p * p) * yy) * h * std::sqrt(h);
        s[i] = -2 / M_PI * std::atan2(mean, std::sqrt(std::max(mean * mean - gauss, 0.0)));
        r[i] = std::sqrt(std::max(2 * mean * mean - gauss, 0.0));
    }
}

int main(int argc, char** argv) {
    if (argc < 4) return 2;
    std::vector<double> in = read_doubles(argv[1]), out(137);
    const double second[3] = {2 * inverse * inverse, -4 * inverse * inverse, 2 * inverse * inverse};
    for (int k = 0; k < 64; k++) {
        double bx[3], by[3], dx[3], dy[3];
        quadratic(-3.5 + k / 8, bx, dx);
        quadratic(-3.5 + k % 8, by, dy);
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) {
                int u = 3 * p + q;
                grid[0](k, u) = dx[p] * by[q], grid[1](k, u) = bx[p] * dy[q], grid[2](k, u) = second[p] * by[q];
                grid[3](k, u) = dx[p] * dy[q], grid[4](k, u) = bx[p] * second[q];
            }
    }
    Vector c;
    int k = 0;
    timed(std::atoi(argv[3]), 20000, [&] {
        in[72 + k++ % 36] += 1e-18;
        fit(36, in.data(), c, &out[9], &out[73]);
    });
    std::copy(c.data(), c.data() + 9, out.begin());
    write_doubles(argv[2], out);
}
