/* The test problems of Cash and Mazzia for COLNEW, whose source is not part of this repository; see compare.py.
 *
 * `colnew TOLERANCE` prints a line for every case: number, epsilon, flag (1: solved), intervals, seconds, and the first component at 201
 * places. `colnew TOLERANCE FILE` solves the cases in the file once each, and prints the values at the places that it names there.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define PI 3.14159265358979323846
#define PLACES 201
#define REALS 12000000
#define INTEGERS 600000

static int number;
static double e, left_end, right_end, first[2];

static double hill(double x) {
    double a = fabs((x - 0.745) / e);
    return 1 + e * (a + log1p(exp(-2 * a)) - log(2));
}

/* w = [f, df/dy, df/dy'] of y'' = f(x, y, y'). */
static void second(double x, double y, double d, double *w) {
    double c = cos(PI * x), s = sin(PI * x), forced = 1 + e * PI * PI, q, g;
    switch (number) {
    case 1: w[0] = y / e, w[1] = 1 / e, w[2] = 0; break;
    case 2: w[0] = d / e, w[1] = 0, w[2] = 1 / e; break;
    case 3: q = 2 + c, w[0] = (y - q * d - forced * c - q * PI * s) / e, w[1] = 1 / e, w[2] = -q / e; break;
    case 4: w[0] = ((1 + e) * y - d) / e, w[1] = (1 + e) / e, w[2] = -1 / e; break;
    case 5: w[0] = (y + x * d - forced * c + PI * x * s) / e, w[1] = 1 / e, w[2] = x / e; break;
    case 6: w[0] = (-x * d - e * PI * PI * c - PI * x * s) / e, w[1] = 0, w[2] = -x / e; break;
    case 7: w[0] = (y - x * d - forced * c - PI * x * s) / e, w[1] = 1 / e, w[2] = -x / e; break;
    case 8: case 18: w[0] = -d / e, w[1] = 0, w[2] = -1 / e; break;
    case 9: q = e + x * x, w[0] = (-2 * y - 4 * x * d) / q, w[1] = -2 / q, w[2] = -4 * x / q; break;
    case 10: w[0] = -x * d / e, w[1] = 0, w[2] = -x / e; break;
    case 11: case 12: case 13: case 14: w[0] = (y - forced * c) / e, w[1] = 1 / e, w[2] = 0; break;
    case 15: w[0] = x * y / e, w[1] = x / e, w[2] = 0; break;
    case 16: q = PI / 2 * (round(1 / e) + 1), w[0] = -q * q * y, w[1] = -q * q, w[2] = 0; break;
    case 17: q = e + x * x, w[1] = -3 * e / (q * q), w[0] = w[1] * y, w[2] = 0; break;
    case 19:
        q = exp(y), g = PI / 2 * sin(PI * x / 2) * q * q;
        w[0] = (g - q * d) / e, w[1] = (2 * g - q * d) / e, w[2] = -q / e;
        break;
    case 20: w[0] = (1 - d * d) / e, w[1] = 0, w[2] = -2 * d / e; break;
    case 21: w[0] = (y + y * y - exp(-2 * x / sqrt(e))) / e, w[1] = (1 + 2 * y) / e, w[2] = 0; break;
    case 22: w[0] = -(d + y * y) / e, w[1] = -2 * y / e, w[2] = -1 / e; break;
    case 23: w[0] = sinh(y / e) / e, w[1] = cosh(y / e) / (e * e), w[2] = 0; break;
    case 24:
        q = 1 + x * x, g = 1.2 - 2 * e * x;
        w[0] = (g * d - d / (y * y) - 2 * x / q * (1 / y - 0.2 * y)) / (e * q);
        w[1] = (2 * d / (y * y * y) + 2 * x / q * (1 / (y * y) + 0.2)) / (e * q);
        w[2] = (g - 1 / (y * y)) / (e * q);
        break;
    default: w[0] = (y - y * d) / e, w[1] = (1 - d) / e, w[2] = -y / e;
    }
}

static void set_ends(void) {
    static const double pairs[6][2] = {{-1. / 3, 1. / 3}, {1, -1. / 3}, {1, 1. / 3}, {1, 1.5}, {0, 1.5}, {-7. / 6, 1.5}};
    double far = exp(-2 / sqrt(e)), q = e;
    left_end = (number >= 3 && number <= 7) || (number >= 9 && number <= 15) ? -1 : 0, right_end = 1;
    switch (number) {
    case 1: case 2: first[0] = 1, first[1] = 0; break;
    case 3: case 5: case 11: first[0] = first[1] = -1; break;
    case 4: first[0] = 1 + exp(-2), first[1] = 1 + exp(-2 * (1 + e) / e); break;
    case 6: first[0] = -2, first[1] = 0; break;
    case 7: first[0] = -1, first[1] = 1; break;
    case 8: first[0] = 1, first[1] = 2; break;
    case 9: first[0] = first[1] = 1 / (1 + e); break;
    case 10: first[0] = 0, first[1] = 2; break;
    case 12: first[0] = -1, first[1] = 0; break;
    case 13: first[0] = 0, first[1] = -1; break;
    case 14: first[0] = first[1] = far; break;
    case 15: first[0] = first[1] = 1; break;
    case 16: first[0] = 0, first[1] = sin(PI / 2 * (round(1 / e) + 1)); break;
    case 17: left_end = -0.1, right_end = 0.1, first[1] = 0.1 / sqrt(q + 0.01), first[0] = -first[1]; break;
    case 18: first[0] = 1, first[1] = exp(-1 / e); break;
    case 19: case 31: first[0] = first[1] = 0; break;
    case 20: first[0] = hill(0), first[1] = hill(1); break;
    case 21: first[0] = 1, first[1] = exp(-1 / sqrt(e)); break;
    case 22: first[0] = 0, first[1] = 0.5; break;
    case 23: case 32: first[0] = 0, first[1] = 1; break;
    case 24: first[0] = 0.9129, first[1] = 0.375; break;
    case 33: first[0] = -1, first[1] = 1; break;
    default: first[0] = pairs[number - 25][0], first[1] = pairs[number - 25][1];
    }
}

static void equations(int *n, double *x, double *z, double *f, double *rpar, int *ipar) {
    double w[3];
    (void)n, (void)rpar, (void)ipar;
    if (number <= 30) {
        second(*x, z[0], z[1], w), f[0] = w[0];
    } else if (number == 31) {
        double bend = 1 / cos(z[1]) + e * z[3] * tan(z[1]);
        f[0] = sin(z[1]), f[1] = z[2], f[2] = -z[3] / e, f[3] = ((z[0] - 1) * cos(z[1]) - z[2] * bend) / e;
    } else if (number == 32) {
        f[0] = (z[1] * z[2] - z[0] * z[3]) / e;
    } else {
        f[0] = (z[0] * z[3] - z[2] * z[1]) / e, f[1] = (-z[2] * z[5] - z[0] * z[1]) / e;
    }
}

/* df[i + j * components] */
static void derivatives(int *n, double *x, double *z, double *df, double *rpar, int *ipar) {
    double w[3];
    (void)n, (void)rpar, (void)ipar;
    if (number <= 30) {
        second(*x, z[0], z[1], w), df[0] = w[1], df[1] = w[2];
    } else if (number == 31) {
        double c = cos(z[1]), sec = 1 / c, tang = tan(z[1]), bend = sec + e * z[3] * tang;
        memset(df, 0, 16 * sizeof *df);
        df[0 + 4] = c, df[1 + 8] = 1, df[2 + 12] = -1 / e;
        df[3] = c / e, df[3 + 8] = -bend / e, df[3 + 12] = -z[2] * tang;
        df[3 + 4] = (-(z[0] - 1) * sin(z[1]) - z[2] * (sec * tang + e * z[3] * sec * sec)) / e;
    } else if (number == 32) {
        df[0] = -z[3] / e, df[1] = z[2] / e, df[2] = z[1] / e, df[3] = -z[0] / e;
    } else {
        memset(df, 0, 12 * sizeof *df);
        df[0] = z[3] / e, df[2] = -z[2] / e, df[4] = -z[1] / e, df[6] = z[0] / e;
        df[1] = -z[1] / e, df[3] = -z[0] / e, df[5] = -z[5] / e, df[11] = -z[2] / e;
    }
}

/* Which component condition i holds, from 0, and its value. */
static int condition(int i, double *value) {
    static const int beam[] = {0, 2, 0, 2}, channel[] = {0, 1, 0, 1}, discs[] = {0, 2, 3, 0, 2, 3};
    *value = 0;
    if (number <= 30) return *value = first[i], 0;
    if (number == 31) return beam[i];
    if (number == 32) return *value = i == 2, channel[i];
    *value = i == 0 ? -1 : i == 3;
    return discs[i];
}

static void conditions(int *i, int *n, double *z, double *g, double *rpar, int *ipar) {
    double value;
    (void)n, (void)rpar, (void)ipar;
    int c = condition(*i - 1, &value);
    *g = z[c] - value;
}

static void condition_derivatives(int *i, int *n, double *z, double *dg, double *rpar, int *ipar) {
    double value;
    (void)z, (void)rpar, (void)ipar;
    for (int k = 0; k < *n; k++) dg[k] = 0;
    dg[condition(*i - 1, &value)] = 1;
}

static void guess(double *x, double *z, double *highest, double *rpar, int *ipar) {
    double slope = (first[1] - first[0]) / (right_end - left_end);
    (void)rpar, (void)ipar;
    for (int k = 0; k < 6; k++) z[k < (number == 33 ? 6 : number >= 31 ? 4 : 2) ? k : 0] = 0;
    z[0] = first[0] + slope * (*x - left_end);
    if (number != 31) z[1] = slope;
    for (int k = 0; k < (number == 31 ? 4 : number == 33 ? 2 : 1); k++) highest[k] = 0;
}

typedef void function();
void colnew_(int *, int *, double *, double *, double *, int *, int *, double *, double *, int *, double *, int *, function *,
             function *, function *, function *, function *, double *, int *, int *);
void appsln_(double *, double *, double *, int *);

/* What COLNEW prints by. */
void rprint_(void) {}
void rprinti1_(void) {}
void rprintid_(void) {}
void rprintd1_(void) {}
void rprintd2_(void) {}
void rprintd3_(void) {}

static double reals[REALS];
static int integers[INTEGERS];

static int solve(double tolerance) {
    int components = number == 31 ? 4 : number == 33 ? 2 : 1, flag, counts[8] = {0}, ipar = 0;
    int orders[4] = {number <= 30 ? 2 : number == 31 ? 1 : number == 32 ? 4 : 2, number == 33 ? 4 : 1, 1, 1};
    int total = number <= 30 ? 2 : number == 33 ? 6 : 4, controlled[2] = {1, 3}, tolerances = number == 33 ? 2 : 1;
    double places[6], allowed[2] = {tolerance, tolerance}, fixed = 0, rpar = 0;
    int settings[12] = {number > 18, 4, 10, tolerances, REALS, INTEGERS, 1, 0, number > 18, 0, 0};
    for (int i = 0; i < total; i++) places[i] = i < total / 2 ? left_end : right_end;
    colnew_(&components, orders, &left_end, &right_end, places, settings, controlled, allowed, &fixed, integers, reals, &flag,
            (function *)equations, (function *)derivatives, (function *)conditions, (function *)condition_derivatives,
            (function *)guess, &rpar, &ipar, counts);
    return flag;
}

/* The cases of a file of lines "number,epsilon,places,values", where places are separated by blanks. */
static int solve_file(double tolerance, const char *name) {
    static char line[1 << 16];
    FILE *file = fopen(name, "r");
    if (!file) return 1;
    while (fgets(line, sizeof line, file)) {
        char *at = line;
        number = strtol(at, &at, 10), e = strtod(at + 1, &at);
        set_ends();
        int flag = solve(tolerance);
        printf("%d,%g,%d,%d,0,", number, e, flag, integers[0]);
        while (flag == 1 && (*at == ',' || *at == ' ')) {
            double z[6], x = strtod(at + 1, &at);
            appsln_(&x, z, reals, integers);
            printf("%.12g ", z[0]);
            if (*at == ',') break;
        }
        printf("\n");
    }
    return fclose(file);
}

int main(int count, char **arguments) {
    double tolerance = count > 1 ? strtod(arguments[1], NULL) : 1e-6;
    if (count > 2) return solve_file(tolerance, arguments[2]);
    for (number = 1; number <= 33; number++) {
        for (int k = 1; k <= 4; k++) {
            e = pow(10, -k);
            if (number == 23 && k > 2) continue;
            set_ends();
            double fastest = INFINITY;
            int flag = 0;
            for (int run = 0; run < 5; run++) {
                clock_t start = clock();
                flag = solve(tolerance);
                fastest = fmin(fastest, (double)(clock() - start) / CLOCKS_PER_SEC);
            }
            printf("%d,%g,%d,%d,%g,", number, e, flag, integers[0], fastest);
            for (int i = 0; flag == 1 && i < PLACES; i++) {
                double x = left_end + (right_end - left_end) * i / (PLACES - 1), z[6];
                appsln_(&x, z, reals, integers);
                printf("%.12g ", z[0]);
            }
            printf("\n");
            fflush(stdout);
        }
    }
    return 0;
}
