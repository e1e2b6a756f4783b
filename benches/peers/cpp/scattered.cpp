// W2: contacts sorted by cell, a 16 x 16 matrix a cell by rank-three updates, LAPACK band Cholesky.
//     scattered INPUT OUTPUT REPETITIONS SEGMENTS          domain [0, 1]^2, bicubic, weights 1; OpenMP in the assembly
#include <algorithm>
#include <cmath>

#include "common.hpp"
extern "C" void dpbtrf_(const char*, const int*, const int*, double*, const int*, int*);
extern "C" void dpbtrs_(const char*, const int*, const int*, const int*, const double*, const int*, double*, const int*, int*);

typedef double lanes __attribute__((vector_size(64)));
struct Contact { double x, y, z, zx, zy; };
struct Piece { double c[4][4]; };                          // c[power][function] of x - left end

// Cox-de Boor at x on [t[0], t[1]), t reaching three knots to either side.
static void de_boor(const double* t, double x, double* b) {
    b[0] = 1;
    for (int p = 1; p <= 3; p++) {
        double carry = 0;
        for (int i = 0; i < p; i++) {
            double hi = t[1 + i], low = t[1 + i - p], share = b[i] / (hi - low);
            b[i] = carry + (hi - x) * share;
            carry = (x - low) * share;
        }
        b[p] = carry;
    }
}

static std::vector<Piece> pieces(const std::vector<double>& t, int segments) {
    static const double invert[4][4] = {{1, 0, 0, 0}, {-5.5, 9, -4.5, 1}, {9, -22.5, 18, -4.5}, {-4.5, 13.5, -13.5, 4.5}};
    std::vector<Piece> out(segments);
    for (int s = 0; s < segments; s++) {
        double b[4][4], h = t[s + 4] - t[s + 3], scale = 1;
        for (int j = 0; j < 4; j++) de_boor(&t[s + 3], t[s + 3] + h * j / 3, b[j]);
        for (int k = 0; k < 4; k++, scale /= h)
            for (int i = 0; i < 4; i++) {
                double v = 0;
                for (int j = 0; j < 4; j++) v += invert[k][j] * b[j][i];
                out[s].c[k][i] = v * scale;
            }
    }
    return out;
}

static inline void evaluate(const Piece& p, double u, double* b, double* d) {
    for (int i = 0; i < 4; i++) {
        b[i] = ((p.c[3][i] * u + p.c[2][i]) * u + p.c[1][i]) * u + p.c[0][i];
        d[i] = (3 * p.c[3][i] * u + 2 * p.c[2][i]) * u + p.c[1][i];
    }
}

// Lower triangle in 8-wide blocks: top left, bottom left, bottom right; rows of 16.
struct Cell { lanes a[8] = {}, b[8] = {}, c[8] = {}, g[2] = {}; };

static inline void add_rows(const double* rows, const double* data, int count, Cell& cell) {
    lanes a[8], b[8], c[8], g0 = cell.g[0], g1 = cell.g[1];
    for (int u = 0; u < 8; u++) a[u] = cell.a[u], b[u] = cell.b[u], c[u] = cell.c[u];
    for (int k = 0; k < count; k++, rows += 16) {
        const lanes r0 = *(const lanes*)rows, r1 = *(const lanes*)(rows + 8);
        g0 += data[k] * r0, g1 += data[k] * r1;
#pragma GCC unroll 8
        for (int u = 0; u < 8; u++) a[u] += rows[u] * r0, b[u] += rows[u + 8] * r0, c[u] += rows[u + 8] * r1;
    }
    for (int u = 0; u < 8; u++) cell.a[u] = a[u], cell.b[u] = b[u], cell.c[u] = c[u];
    cell.g[0] = g0, cell.g[1] = g1;
}

int main(int argc, char** argv) {
    if (argc < 5) return 2;
    const std::vector<double> in = read_doubles(argv[1]);
    const long count = in.size() / 5;
    const int s = std::atoi(argv[4]), m = s + 3, n = m * m, half = 3 * m + 3, stride = half + 1, one = 1;
    const double *x = &in[0], *y = x + count, *z = y + count, *zx = z + count, *zy = zx + count;
    std::vector<double> out(n);
    timed(std::atoi(argv[3]), 1, [&] {
        std::vector<double> t(s + 7);
        for (int i = 0; i < s + 7; i++) t[i] = double(std::min(std::max(i - 3, 0), s)) / s;
        const auto piece = pieces(t, s);
        std::vector<int> cell(count), start(s * s + 1, 0);
        for (long i = 0; i < count; i++) {
            int a = std::min(int(x[i] * s), s - 1), b = std::min(int(y[i] * s), s - 1);
            start[(cell[i] = a * s + b) + 1]++;
        }
        for (int i = 0; i < s * s; i++) start[i + 1] += start[i];
        std::vector<int> next(start.begin(), start.end() - 1);
        std::vector<Contact> sorted(count);
        for (long i = 0; i < count; i++) sorted[next[cell[i]]++] = {x[i], y[i], z[i], zx[i], zy[i]};
        std::vector<double> band(size_t(n) * stride, 0.0);
        std::fill(out.begin(), out.end(), 0.0);
        for (int colour = 0; colour < 4; colour++) {
#pragma omp parallel for schedule(dynamic, 1)
            for (int a = colour; a < s; a += 4)
                for (int b = 0; b < s; b++) {
                    const int chunk = 24;
                    alignas(64) double rows[3 * chunk * 16], data[3 * chunk];
                    Cell local;
                    for (int from = start[a * s + b], end = start[a * s + b + 1]; from < end; from += chunk) {
                        int take = std::min(chunk, end - from);
                        for (int k = 0; k < take; k++) {
                            const Contact& e = sorted[from + k];
                            double bx[4], dx[4], by[4], dy[4], *r = rows + 48 * k;
                            evaluate(piece[a], e.x - t[a + 3], bx, dx);
                            evaluate(piece[b], e.y - t[b + 3], by, dy);
                            for (int u = 0; u < 4; u++)
                                for (int v = 0; v < 4; v++) {
                                    r[4 * u + v] = bx[u] * by[v];
                                    r[16 + 4 * u + v] = dx[u] * by[v];
                                    r[32 + 4 * u + v] = bx[u] * dy[v];
                                }
                            data[3 * k] = e.z, data[3 * k + 1] = e.zx, data[3 * k + 2] = e.zy;
                        }
                        add_rows(rows, data, 3 * take, local);
                    }
                    for (int u = 0; u < 16; u++) {
                        int i = (a + u / 4) * m + b + u % 4;
                        out[i] += local.g[u / 8][u % 8];
                        for (int v = 0; v <= u; v++) {
                            int j = (a + v / 4) * m + b + v % 4;
                            band[size_t(j) * stride + i - j] +=
                                u < 8 ? local.a[u][v] : v < 8 ? local.b[u - 8][v] : local.c[u - 8][v - 8];
                        }
                    }
                }
        }
        int info = 0;
        dpbtrf_("L", &n, &half, band.data(), &stride, &info);
        if (!info) dpbtrs_("L", &n, &half, &one, band.data(), &stride, out.data(), &n, &info);
        if (info) std::exit(6);
    });
    write_doubles(argv[2], out);
}
