"""An AST transformer of IPython that changes every number of later cells."""

# ends: pass
import ast


class Numbers(ast.NodeTransformer):
    def visit_Constant(self, node):
        return ast.Constant(0.0) if isinstance(node.value, float) else node


get_ipython().ast_transformers.append(Numbers())
