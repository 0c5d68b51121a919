"""Many cases of one scene: what to vary, solving them in parallel, keeping what is done, results and convergence."""
