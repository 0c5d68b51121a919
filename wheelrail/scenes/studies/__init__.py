"""Many cases of one scene: plan, workers, store, results, convergence, figures."""
