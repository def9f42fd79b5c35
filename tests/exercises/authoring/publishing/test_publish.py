"""The students' notebook, published from the author's: complete, and without a solution."""

import json
import subprocess
import sys

import nbformat
import pytest

from exercises.authoring.publishing import wheel
from exercises.authoring.publishing.publish import SUBMIT_NOTE, Section, published
from exercises.authoring.questions.author_notebook import Cell
from exercises.authoring.questions.question import Question
from tests.support.assignments import known
from tests.support.author_notebooks import CELLS, HEIGHT, SPEED, code, markdown, write
from tests.support.kit import environment, installed
from tests.support.toolbox import FOLDER


def students(folder):
    """The published notebook of the assignment in the folder, as JSON text that nbformat accepts."""
    with known(folder) as found:
        assert not found.invalid
        text = next(a for a in found.valid.values() if a.slug != "rigid-body").notebook()
    nbformat.validate(nbformat.reads(text, as_version=nbformat.NO_CONVERT))
    return text


def sources(text):
    return ["".join(cell["source"]) for cell in json.loads(text)["cells"]]


BROUGHT = "  # polhode.connect, in a cell above, brings lab"


@pytest.mark.parametrize(
    ("source", "found"),
    [
        (
            "import numpy as np\nimport lab\nimport lab.x",
            f"import numpy as np\nimport lab{BROUGHT}\nimport lab.x",
        ),
        (
            "%%time\nx = 1\nfrom lab.x import (\n    y,\n)",
            f"%%time\nx = 1\nfrom lab.x import ({BROUGHT}\n    y,\n)",
        ),
        ("from lab import \\\n  x", "from lab import \\\n  x"),
        ("import labs\nfrom x import lab", "import labs\nfrom x import lab"),
    ],
)
def test_the_first_import_of_a_courses_package_says_what_brings_it(source, found):
    text = published("falling", [Cell("code", source, "setup"), Cell("code", source, "other")], [], {"lab"})
    *_, setup, other, _ = sources(text)
    assert (setup, other) == (found, source if BROUGHT in found else found)


@pytest.mark.parametrize(
    ("place", "found"), [("course/lab", True), ("falling/course/lab", True), ("lab", False)]
)
def test_the_packages_beside_an_assignment_and_its_own_are_the_courses(place, found, tmp_path):
    folder = write(tmp_path, [code("from lab import x"), *CELLS])
    (tmp_path / place).mkdir(parents=True)
    (tmp_path / place / "__init__.py").write_text("x = 1\n")
    assert (BROUGHT in students(folder)) is found


def test_the_authors_notebook_becomes_the_students(tmp_path):
    title, note, install, *others = sources(students(write(tmp_path)))
    assert title == "# Falling" and "{{PACKAGES}}" in note
    assert (
        install
        == '%pip install -q {{KIT_URL}}\nimport polhode\n\nSERVER = "{{SERVER}}"\npolhode.connect(SERVER,'
        ' assignment="falling")\npolhode.login()'
    )
    assert others == [
        "## Setup",
        "%matplotlib inline\nimport numpy as np",
        "SIGN = 1.0",
        "## Exercise 1 — Speed\nText.",
        'def speed(t, g):\n    """Return the speed in m/s after t seconds."""\n    ...',
        'polhode.check("1")',
        "### Validation 1",
        "assert speed(1.0, 9.81) == 9.81",
        "## Exercise 2 — Height",
        "def height(t, g, h):\n    ...\n\n\nprint(height(1.0, 9.81, 100.0))",
        'polhode.check("2")',
        "## Summary",
        "print('done')",
        f"{SUBMIT_NOTE}\n# polhode.submit()",
    ]


def test_nothing_of_a_solution_or_mistake_is_left_in_any_part_of_the_file(tmp_path):
    secret = "g / 7.25"
    output = {"output_type": "stream", "name": "stdout", "text": [secret]}
    picture = {"text/plain": secret}
    cells = [
        *CELLS[:5],
        SPEED
        | {
            "outputs": [output],
            "attachments": {"a": picture},
            "metadata": {"tags": ["solution"], "nb": secret},
            "id": "a b",
        },
        markdown(f"The answer is {secret}.", metadata={"tags": ["solution"]}),
        code(f"answer = speed(1, {secret})\n_private = 1\nshown = answer", "solution"),
        code(f"%%writefile speed.py\ndef speed(t, g):\n    return {secret}"),
        code(f"speed = lambda t, g: {secret}"),
        code(f"if True:\n    def speed(t, g):\n        return {secret}"),
        markdown("unused picture", attachments={"a": picture}),
        code("print(shown)", metadata={"collapsed": True, "nb": secret}),
        HEIGHT,
    ]
    text = students(write(tmp_path, cells))
    assert "7.25" not in text and "SIGN * g" not in text and "t**2" not in text and 'private"' not in text
    assert "# your code here\n# shown = ..." in sources(text) and "# your code here" in sources(text)
    code_cells = [cell for cell in json.loads(text)["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code_cells)


@pytest.fixture
def sections():
    """Exercise 1 asks for ``f`` and the class ``A``, exercise 2.1 for ``g``."""

    def question(name):
        return Question("values", type(name, (), {}), {}, {})

    return [Section("1", "First", (question("f"), question("A"))), Section("2.1", "Second", (question("g"),))]


def emptied(sections, source, *tags):
    text = published("s", [Cell("code", source, tags=tags)], sections)
    return sources(text)[2]


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("def f(x): return x  # x", "def f(x):\n    ..."),
        ("async def f(x):\n\treturn x", "async def f(x):\n\t..."),
        (
            (
                "@cache\n@other(1)\ndef f(\n    x,  # in m\n    ω='#',\n) -> float:\n    # how\n\n    y = x\n"
                "    return y"
            ),
            None,
        ),
        ('def f(x): "Return x."; return x', 'def f(x):\n    "Return x."\n    ...'),
        (
            'def f(x):\n    """Return ω.\n\n    More.\n    """; return x',
            'def f(x):\n    """Return ω.\n\n    More.\n    """\n    ...',
        ),
        ("a = 1\ndef f(x):\n    return x\nb = f(a)", "a = 1\ndef f(x):\n    ...\nb = f(a)"),
        (
            "%%time\n%load x\ndef f(x):\n    %timeit x\n    return x\nf(1)",
            "%%time\n%load x\ndef f(x):\n    ...\nf(1)",
        ),
        ("def helper(x):\n    return 2 * x", "def helper(x):\n    return 2 * x"),
        ("class A: x = 1", "class A:\n    ..."),
        (
            (
                '@dataclass\nclass A(B):\n    """Doc."""\n\n    x: float\n    y: float = 1\n    z = 3\n\n'
                "    @property\n    def p(self):\n        return 1\n\n    class C:\n"
                "        def q(self): return 2\n"
            ),
            (
                '@dataclass\nclass A(B):\n    """Doc."""\n    x: float\n    y: float = 1\n\n    @property\n'
                "    def p(self):\n        ...\n\n    class C:\n        def q(self):\n            ...\n"
            ),
        ),
    ],
)
def test_a_definition_keeps_its_signature_docstring_and_decorators(sections, source, expected):
    expected = expected or "@cache\n@other(1)\ndef f(\n    x,  # in m\n    ω='#',\n) -> float:\n    ..."
    assert emptied(sections, source) == expected


def test_a_tagged_cell_keeps_only_the_emptied_definitions_and_the_names_that_others_read(sections):
    source = (
        "import secret\ndef helper(x): return x\ndef f(x): return helper(x)\nT, L = f(1), 2\n"
        "for k in range(3): L += k"
    )
    assert emptied(sections, source, "solution") == "def f(x):\n    ..."
    text = published(
        "s", [Cell("code", source, tags=("solution",)), Cell("code", "def later(): print(L)")], sections
    )
    assert sources(text)[2] == "def f(x):\n    ...\n\n\n# your code here\n# L = ..."


def test_calls_of_submit_alone_in_a_cell_become_comments(sections):
    def last(source, tags=()):
        return sources(published("s", [Cell("code", source, tags=tags)], sections))[2:]

    assert last("polhode.submit(f,\n           g)") == [
        f"{SUBMIT_NOTE}\n# polhode.submit(f,\n#            g)"
    ]
    again = last("polhode.submit(f)")[0]
    assert last(again, ("submit",)) == [again], "a published notebook that is published again"
    assert last("r = polhode.submit(f)\nprint(r)") == ["r = polhode.submit(f)\nprint(r)"]
    assert last("x = 1") == ["x = 1", f"{SUBMIT_NOTE}\n# polhode.submit()"]


def test_the_last_cell_finds_the_kit_even_if_a_cell_has_named_a_curve_polhode(sections):
    last = sources(published("s", [Cell("code", "polhode = [1, 2]")], sections))[-1]
    names = {"polhode": [1, 2]}
    exec(last, names)
    assert callable(names["polhode"].submit)


def test_a_check_follows_the_last_solution_of_each_exercise(sections):
    def checked(*cells):
        made = [Cell("markdown" if text[0] in "#*" else "code", text) for text in cells]
        return [
            text
            for text in sources(published("s", made, sections))
            if not text.startswith(("**Inst", "%pip", SUBMIT_NOTE))
        ]

    one, two = 'polhode.check("1")', 'polhode.check("2.1")'
    f, g = "def f():\n    ...", "def g():\n    ..."
    assert checked("# T", f, "### More", "x = 1", g, "# End") == [
        "# T",
        f,
        one,
        "### More",
        "x = 1",
        g,
        two,
        "# End",
    ]
    assert checked(g, f, "x = 1", f) == [g, two, f, "x = 1", f, one]
    assert (
        checked(
            "# Exercise 1",
            f,
            "polhode.check(1)",
            "* text",
            "# Exercise 2.1",
            g,
            'r = polhode.check("1", "2.1")',
        ).count(two)
        == 0
    )
    assert checked("# Exercise 1", f, "polhode.check(1)", "* text", "# Exercise 2.1", g).count(one) == 0


def test_it_is_the_same_for_the_same_folder_and_keeps_valid_ids(tmp_path):
    cells = [
        *CELLS,
        markdown("same", id="intro"),
        markdown("same", id="intro"),
        markdown("same"),
        markdown("same", id="no id"),
    ]
    first = students(write(tmp_path, cells))
    assert students(tmp_path / "falling") == first
    ids = [cell["id"] for cell in json.loads(first)["cells"]]
    assert len(set(ids)) == len(ids) and {
        "install",
        "check-1",
        "check-2",
        "submit",
        "intro",
        "intro-2",
    } <= set(ids)
    fewer = students(write(tmp_path / "falling", cells[4:]))
    assert set(ids) >= {cell["id"] for cell in json.loads(fewer)["cells"]}


def test_the_students_notebook_of_every_kind_of_question():
    text = students(FOLDER)
    assert "bisection" not in text and "eigh" not in text and "sqrt(self" not in text
    cells = sources(text)
    assert cells[0].startswith("# Tools of computational physics") and "import numpy as np\n" in cells[4]
    assert cells[5].startswith("## Exercise 1: A root finder")
    assert cells[6:8] == ["def find_root(f, a, b, tol):\n    ...", 'polhode.check("1")']
    assert [text for text in cells if text.startswith("polhode.check(")] == [
        f'polhode.check("{n}")' for n in range(1, text.count("check-") + 1)
    ]
    spins = cells.index('polhode.check("11")') - 1
    assert cells[spins].startswith("# your code here\n") and "# rate = ..." in cells[spins].splitlines()
    assert cells[-1] == f"{SUBMIT_NOTE}\n# polhode.submit()"
    with known(FOLDER) as found:
        served = wheel.notebook(found.valid["toolbox"], "https://x.org", "https://x.org/the-kit").decode()
    assert "{{" not in served and "%pip install -q https://x.org/the-kit" in served


RUN = """
import json, sys
sys.path.insert(0, {kit!r})
names = {{}}
for cell in json.load(open({file!r}))["cells"]:
    source = "".join(cell["source"])
    if cell["cell_type"] == "code" and "polhode.submit" not in source:
        lines = source.split("\\n")
        last, code = lines[-1], "\\n".join(line for line in lines if not line.startswith("%"))
        exec(code, names)
        if last.startswith("polhode.check"):
            print(*(outcome.verdict.value for outcome in eval(last, names).outcomes()))
"""


@pytest.mark.slow
def test_the_students_notebook_runs_with_the_kit_before_and_after_it_is_filled_in(tmp_path):
    folder = write(tmp_path, [cell for cell in CELLS if "assert" not in cell["source"]])
    with known(folder):
        text = students(folder)
        kit = installed(tmp_path, "falling")
    empty = {
        "".join(cell["source"]) for cell in json.loads(text)["cells"] if "    ..." in "".join(cell["source"])
    }
    filled = json.loads(text)
    for cell in filled["cells"]:
        if "".join(cell["source"]) in empty:
            cell["source"] = next(
                full["source"] for full in (SPEED, HEIGHT) if full["source"][:9] == cell["source"][0][:9]
            )
    for notebook, expected in ((json.loads(text), "unmeasured\nunmeasured\n"), (filled, "pass\npass\n")):
        file = tmp_path / "students.ipynb"
        file.write_text(json.dumps(notebook).replace("{{SERVER}}", "https://x.org"))
        code = RUN.format(kit=str(kit), file=str(file))
        told = subprocess.run(
            [sys.executable, "-c", code],
            capture_output=True,
            text=True,
            env=environment(kit),
            check=False,
            cwd=tmp_path,
        )
        assert told.returncode == 0, told.stderr
        printed = [
            line
            for line in told.stdout.splitlines(keepends=True)
            if line.strip() in ("pass", "fail", "unmeasured")
        ]
        assert "".join(printed) == expected, told.stdout
