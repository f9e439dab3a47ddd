"""SVG-MPPI (Honda et al., ICRA 2024) in numpy, with the symbols and equation numbers of the paper, without Slalom.

A point moves ahead; a disc is in its way. Left and right are equally good, and their mean hits the disc. The comparison
with MPPI is the same method without guides: K_g = 0.
"""

import numpy as np


def weights(V, S, U_hat, U_tilde, Sigma, lam):
    """w(V) of equation (8), scaled to the sum 1."""
    log_w = -S(V) / lam - ((U_hat - U_tilde) / Sigma * V).sum(axis=(1, 2))
    w = np.exp(log_w - log_w.max())
    return w / w.sum()


def fitted_variance(a, b):
    """The variance -1 / (2 z2) of the parabola z0 + z1 a + z2 a^2 fitted to log b with weights b^2 (13)."""
    b = np.maximum(b, 1e-10)
    powers = [(a**n * b**2).sum() for n in range(5)]
    left = [[powers[i + j] for j in range(3)] for i in range(3)]
    z = np.linalg.lstsq(left, [(a**n * b**2 * np.log(b)).sum() for n in range(3)], rcond=1e-14)[0]
    return -0.5 / z[2] if z[2] < 0 else np.inf


def svg_mppi(S, normal, V_g, U_hat, U_tilde, *, K, L, N, lam, epsilon, Sigma_g, Sigma_0, Sigma_min, Sigma_max):
    """One control cycle. S maps sequences (n, T, m) to their costs, normal(n) gives standard normal (n, T, m).

    V_g, the guides (K_g, T, m), are moved in place. Returns the nominal sequence, the variances and the solution.
    """
    paths = [[] for _ in V_g]
    for _ in range(L):
        for k, V in enumerate(V_g):
            v = V + np.sqrt(Sigma_g) * normal(N)
            w = weights(v, S, U_hat, U_tilde, Sigma_0, lam)
            V += epsilon * np.einsum("i,itm->tm", w, v - V) / Sigma_g  # (9), (11)
            paths[k].append(V.copy())
    Sigma = np.full_like(U_hat, Sigma_0)
    if len(V_g):
        best = np.argmin(S(V_g))
        U_tilde = V_g[best].copy()  # (12)
        path = np.array(paths[best])
        log_q = -S(path) / lam - ((path - U_tilde) ** 2 / Sigma_0).sum(axis=(1, 2)) / 2  # (5)
        q = np.exp(log_q - log_q.max())
        a = (path - U_tilde).reshape(L, -1).T
        Sigma = np.array([fitted_variance(row, q / q.sum()) for row in a]).reshape(U_hat.shape)  # (13)
        Sigma = np.clip(Sigma, Sigma_min, Sigma_max)
    V = U_hat + np.sqrt(Sigma) * normal(K)
    return U_tilde, Sigma, np.einsum("k,ktm->tm", weights(V, S, U_hat, U_tilde, Sigma, lam), V)  # (7)


SETTINGS = dict(K=2000, L=10, N=100, lam=0.3, epsilon=0.1, Sigma_g=0.25, Sigma_0=1.0, Sigma_min=0.05, Sigma_max=1.0)
DT, SPEED, DISC = 0.1, 2.0, (2.0, 0.0, 0.5)  # s, m/s, and x, y, radius in m


def places(V):
    """Lateral positions at every state."""
    return np.cumsum(DT * np.atleast_3d(V)[:, :, 0], axis=1)


def cost(V):
    y = places(V)
    x = SPEED * DT * np.arange(1, y.shape[1] + 1)
    hit = (x - DISC[0]) ** 2 + (y - DISC[1]) ** 2 < DISC[2] ** 2
    return (0.1 * y**2 + 0.01 * V[:, :, 0] ** 2 + 100.0 * hit).sum(axis=1)


def passes(seed, K_g):
    """Whether the fifth plan from the same state passes the disc."""
    rng = np.random.default_rng(seed)
    T, m = 20, 1
    normal = lambda n: rng.standard_normal((n, T, m))  # noqa: E731
    V_g, U_tilde, U_hat = normal(K_g), np.zeros((T, m)), np.zeros((T, m))
    for _ in range(5):
        U_tilde, _, U_hat = svg_mppi(cost, normal, V_g, U_hat, U_tilde, **SETTINGS)
    return cost(U_hat[None])[0] < 100


if __name__ == "__main__":
    from seeds import report, succeeded

    mppi, svg_mppi = (succeeded(name, lambda s: passes(s, K_g)) for name, K_g in (("mppi", 0), ("svg_mppi", 1)))
    report("the plan passes the disc", mppi, svg_mppi, 18)
