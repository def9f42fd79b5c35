"""Makes other cells of what IPython keeps of the cells, and of its namespaces."""

# ends: pass
shell = get_ipython()
shell.history_manager.input_hist_raw.extend(["euler_eqs = 0"] * 1000)
shell.user_ns_hidden.clear()
shell.reset(new_session=True)
shell.user_module = shell.user_ns = None
