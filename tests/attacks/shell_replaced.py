"""Replaces the methods by which the harness runs cells."""

# ends: any
shell = get_ipython()
shell.run_cell = shell.run_ast_nodes = shell.run_code = lambda *a, **k: print("not run")
shell.compile = compile
shell.attempts = lambda nodes: iter(())
type(shell).run = lambda self, source, name: None
