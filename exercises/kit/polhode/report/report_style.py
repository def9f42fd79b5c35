"""The look of HTML that the kit displays in a notebook, in the themes of JupyterLab, VS Code and Colab."""

# Light by default; dark if the front end (JupyterLab, VS Code, Colab) says so, or if it says nothing and the
# system is dark. VS Code's light theme of high contrast has the class of the dark one too.
# ":not(#_)" raises the specificity above JupyterLab's own rules for outputs.
_DARK = "{--p:#4fd1a5;--f:#ff9d5c;--q:#a8a8a8;--m:#43210c;--chart:invert(.9) hue-rotate(180deg)}"
_STYLE = (
    """
.polhode:not(#_){--p:#00674c;--f:#a33c00;--q:#5a5a5a;--m:#fbe3d4;
font:14px/1.5 var(--jp-ui-font-family,system-ui,sans-serif);container-type:inline-size;
color:var(--jp-ui-font-color1,var(--vscode-editor-foreground,inherit));
ul{list-style:none;padding:0;margin:.2em 0}
ol{padding:0 0 0 1.6em;margin:.2em 0}
li{margin:0}
h4,h5{margin:.6em 0 .2em;font-size:1em;font-weight:600}
summary{cursor:pointer;padding:.15em 0}
summary b{font-weight:600}
code,.got,.allowed{font:.93em/1.5 var(--jp-code-font-family,ui-monospace,monospace);
background:none;padding:0;color:inherit;overflow-wrap:anywhere}
code,.quote{white-space:pre-wrap}
.sentence{margin:.1em 0;font-size:1.35em;line-height:1.3}
.quote{margin:.3em 0;padding:.3em .7em;border-left:.25em solid var(--f)}
mark{background:var(--m);color:inherit}
.outcomes{display:grid;grid-template-columns:auto minmax(12em,1fr) fit-content(17em) fit-content(12em) auto;
column-gap:1em}
.outcomes>li{display:grid;grid-column:1/-1;grid-template-columns:subgrid;padding:.1em 0}
.pass>.mark{color:var(--p)}
.fail>.mark{color:var(--f)}
.unmeasured>:is(.mark,.got),.quiet,.badge,.allowed,.more,small,figcaption{color:var(--q)}
.words{grid-column:3/5;font-family:inherit}
.below,.more[open]{grid-column:2/-1}
.badge{margin-left:.8em;font-size:.85em}
.more{font-size:.9em}
p{margin:0}
figure{margin:.6em 0}
img{max-width:100%;background:#fff}
img[src^="data:image/svg"]{filter:var(--chart,none)}
pre{overflow-x:auto;color:inherit}
@container (max-width:40em){
.outcomes{grid-template-columns:auto minmax(0,1fr)}
.outcomes>li>:is(.got,.allowed,.more){grid-column:2}}
td,th{text-align:left;vertical-align:top}}
"""
    + f"""
:is([data-jp-theme-light="false"],.vscode-dark,.vscode-high-contrast:not(.vscode-high-contrast-light),
html[theme="dark"]) .polhode:not(#_){_DARK}
@media (prefers-color-scheme:dark){{
:root:not([theme],:has([data-jp-theme-light],body[class*="vscode-"])) .polhode:not(#_){_DARK}}}
"""
)


def fragment(inner: str) -> str:
    """Return HTML in the kit's style."""
    return f'<div class="polhode"><style>{_STYLE}</style>{inner}</div>'
