/* Solves H x = b for a symmetric matrix in blocks of M with
 *     H_ij = U_i W_{i+1} ... W_{j-1} V_j^T,  i < j,
 * densely and node by node. Both stop where a pivot is not positive.
 * Compiled by structure.py with M, the strains of a node, and R, the rank. */
#include <math.h>
#include <string.h>

typedef struct {
    double diagonal[M][M], u[M][R], w[R][R], v[M][R]; /* given */
    double lower[M][M], half[M][R], y[M];             /* found */
} Node;

/* Eliminates the nodes in order. With those before k gone, H_ij has become
 * H_ij - V_i W^T ... P ... W V_j^T, and P is all that is carried outward. */
static int recursion(int nodes, Node *chain, const double *b, double *x) {
    double p[R][R] = {{0}}, carried[R] = {0}, beyond[R] = {0};
    for (int k = 0; k < nodes; k++) {
        Node *n = &chain[k];
        double vp[M][R], pw[R][R], next[R][R], sum[R];
        for (int i = 0; i < M; i++)
            for (int j = 0; j < R; j++) {
                double s = 0;
                for (int l = 0; l < R; l++) s += n->v[i][l] * p[l][j];
                vp[i][j] = s;
            }
        for (int i = 0; i < M; i++) {
            for (int j = 0; j <= i; j++) {
                double s = n->diagonal[i][j];
                for (int l = 0; l < R; l++) s -= vp[i][l] * n->v[j][l];
                for (int l = 0; l < j; l++) s -= n->lower[i][l] * n->lower[j][l];
                if (i == j && !(s > 0)) return 0;
                n->lower[i][j] = i == j ? 1 / sqrt(s) : s * n->lower[j][j];
            }
            for (int j = 0; j < R; j++) {
                double s = n->u[i][j];
                for (int l = 0; l < R; l++) s -= vp[i][l] * n->w[l][j];
                for (int l = 0; l < i; l++) s -= n->lower[i][l] * n->half[l][j];
                n->half[i][j] = s * n->lower[i][i];
            }
            double s = b[k * M + i];
            for (int l = 0; l < R; l++) s -= n->v[i][l] * carried[l];
            for (int l = 0; l < i; l++) s -= n->lower[i][l] * n->y[l];
            n->y[i] = s * n->lower[i][i];
        }
        for (int i = 0; i < R; i++)
            for (int j = 0; j < R; j++) {
                double s = 0;
                for (int l = 0; l < R; l++) s += p[i][l] * n->w[l][j];
                pw[i][j] = s;
            }
        for (int i = 0; i < R; i++) {
            for (int j = 0; j < R; j++) {
                double s = 0;
                for (int l = 0; l < R; l++) s += n->w[l][i] * pw[l][j];
                for (int l = 0; l < M; l++) s += n->half[l][i] * n->half[l][j];
                next[i][j] = s;
            }
            double s = 0;
            for (int l = 0; l < R; l++) s += n->w[l][i] * carried[l];
            for (int l = 0; l < M; l++) s += n->half[l][i] * n->y[l];
            sum[i] = s;
        }
        memcpy(p, next, sizeof p);
        memcpy(carried, sum, sizeof carried);
    }
    for (int k = nodes - 1; k >= 0; k--) {
        Node *n = &chain[k];
        double sum[R];
        for (int i = M - 1; i >= 0; i--) {
            double s = n->y[i];
            for (int l = 0; l < R; l++) s -= n->half[i][l] * beyond[l];
            for (int l = i + 1; l < M; l++) s -= n->lower[l][i] * x[k * M + l];
            x[k * M + i] = s * n->lower[i][i];
        }
        for (int i = 0; i < R; i++) {
            double s = 0;
            for (int l = 0; l < M; l++) s += n->v[l][i] * x[k * M + l];
            for (int l = 0; l < R; l++) s += n->w[i][l] * beyond[l];
            sum[i] = s;
        }
        memcpy(beyond, sum, sizeof beyond);
    }
    return 1;
}

/* Cholesky by rows of the upper factor, four at a time, as the engine does it. */
static int dense(int n, const double *h, double *f, double *inverse, const double *b, double *x) {
    for (int i = 0; i < n; i++) {
        double *row = &f[i * n + i];
        int width = n - i, k = 0;
        memcpy(row, &h[i * n + i], width * sizeof(double));
        for (; k + 4 <= i; k += 4) {
            const double *a0 = &f[k * n + i], *a1 = a0 + n, *a2 = a1 + n, *a3 = a2 + n;
            double m0 = a0[0], m1 = a1[0], m2 = a2[0], m3 = a3[0];
            for (int j = 0; j < width; j++)
                row[j] -= (m0 * a0[j] + m1 * a1[j]) + (m2 * a2[j] + m3 * a3[j]);
        }
        for (; k < i; k++) {
            const double *other = &f[k * n + i];
            double m = other[0];
            for (int j = 0; j < width; j++) row[j] -= m * other[j];
        }
        if (!(row[0] > 0)) return 0;
        inverse[i] = 1 / sqrt(row[0]);
        for (int j = 0; j < width; j++) row[j] *= inverse[i];
    }
    memcpy(x, b, n * sizeof(double));
    for (int i = 0; i < n; i++) {
        double y = x[i] *= inverse[i];
        for (int j = i + 1; j < n; j++) x[j] -= y * f[i * n + j];
    }
    for (int i = n - 1; i >= 0; i--) {
        double s = 0;
        for (int j = i + 1; j < n; j++) s += f[i * n + j] * x[j];
        x[i] = (x[i] - s) * inverse[i];
    }
    return 1;
}

/* The same many times over, to be timed. */
int recursions(int times, int nodes, Node *chain, const double *b, double *x) {
    int good = 1;
    while (times-- > 0) good &= recursion(nodes, chain, b, x);
    return good;
}

int denses(int times, int n, const double *h, double *f, double *inverse, const double *b,
           double *x) {
    int good = 1;
    while (times-- > 0) good &= dense(n, h, f, inverse, b, x);
    return good;
}
