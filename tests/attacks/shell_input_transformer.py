"""Input transformers of IPython that rewrite every later cell, and one that raises."""

# ends: pass
def rewrite(lines):
    print("ESCAPED into the harness" if "scene" in "".join(lines) else "a cell was rewritten")
    raise RuntimeError("not transformed")


get_ipython().input_transformers_cleanup.insert(0, rewrite)
get_ipython().input_transformers_post.append(rewrite)
