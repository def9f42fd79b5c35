"""Breakages of the kit."""

from tests.support.breakages.breakage import Breakage

KIT = [
    Breakage(
        "the course's package that connect brings hides the one that is installed in editable mode",
        "exercises/kit/polhode/client/course_packages.py",
        "sys.meta_path.append(packages)",
        "sys.meta_path.insert(0, packages)",
        ("tests/exercises/kit/polhode/client/test_course_packages.py",),
    ),
    Breakage(
        "close lets a difference that is not a number pass",
        "exercises/kit/polhode/judging/comparisons.py",
        "np.all(np.isfinite(want)) and np.all(delta <= allowed)",
        "np.all(np.isfinite(want)) and not np.any(delta > allowed)",
        ("tests/exercises/kit/polhode/judging/test_comparisons.py",),
    ),
    Breakage(
        "within is content with one value that is close enough",
        "exercises/kit/polhode/judging/comparisons.py",
        "np.all(used <= limit)",
        "np.any(used <= limit)",
        ("tests/exercises/kit/polhode/judging/test_comparisons.py",),
    ),
    Breakage(
        "conserved compares the last value only",
        "exercises/kit/polhode/judging/comparisons.py",
        "np.all(drift <= limit)",
        "drift[-1] <= limit",
        ("tests/exercises/kit/polhode/judging/test_comparisons.py",),
    ),
    Breakage(
        "below is judged the other way round",
        "exercises/kit/polhode/judging/comparisons.py",
        "np.all(values <= limit)",
        "np.all(values >= limit)",
        ("tests/exercises/kit/polhode/judging/test_comparisons.py",),
    ),
    Breakage(
        "infinite values are compared like others",
        "exercises/kit/polhode/judging/checks.py",
        "and not np.all(np.isfinite(array))",
        "and np.any(np.isnan(array))",
        ("tests/exercises/kit/polhode/judging/test_checks.py",),
    ),
    Breakage(
        "a returned array of the wrong shape is taken",
        "exercises/kit/polhode/judging/return_value.py",
        "if array.shape != shape:",
        "if array.ndim != len(shape):",
        ("tests/exercises/kit/test_polhode.py",),
    ),
    Breakage(
        "the local check compares every scene with the first one's truth",
        "exercises/kit/polhode/client/local.py",
        "[known.scenes[name].truth for name in check.scenes]",
        "[known.scenes[check.scenes[0]].truth for name in check.scenes]",
        ("tests/exercises/kit/polhode/client/test_local.py::test_a_right_function_passes_in_a_kernel_too",),
    ),
    Breakage(
        "an exercise with a cause of its own is folded under the cause of another",
        "exercises/kit/polhode/report/report_overview.py",
        "same = bool(sentences) and all(given) and sentences <= shown",
        "same = bool(sentences) and all(given) and bool(sentences & shown)",
        ("tests/exercises/kit/polhode/report/test_report_overview.py",),
    ),
    Breakage(
        "the line of the first definition is quoted, not that of the last, which runs",
        "exercises/kit/polhode/report/student_line.py",
        "begin = found[-1].start()",
        "begin = found[0].start()",
        ("tests/exercises/kit/polhode/report/test_student_line.py",),
    ),
    Breakage(
        "a failure whose inputs are all right earns all points",
        "exercises/kit/polhode/judging/outcome.py",
        "return min(self.points * self.partial.right // self.partial.rows, self.points - 1)",
        "return self.points * self.partial.right // self.partial.rows",
        ("tests/exercises/kit/polhode/report/test_report.py",),
    ),
    Breakage(
        "an override of a check ignores the partial credit it replaces",
        "service/store/submissions/records.py",
        "least(o.points, v.points) - v.earned",
        "least(o.points, v.points) - CAST(v.state = 'pass' AS int)",
        ("tests/service/store/course/test_overrides.py::test_a_check_of_four_points",),
    ),
    Breakage(
        "a report passes if nothing in it failed",
        "exercises/kit/polhode/report/report.py",
        "return bool(self.max_score) and all(outcome.verdict is Verdict.PASS for outcome in counted)",
        "return not any(o.verdict is Verdict.FAIL for o in self.outcomes())",
        ("tests/exercises/kit/polhode/report/test_report.py",),
    ),
    Breakage(
        "the kit follows a redirect to another host, with the token",
        "exercises/kit/polhode/client/transport/http.py",
        "if not same_origin(target, request.url):",
        "if not target:",
        (
            "tests/exercises/kit/polhode/client/transport/test_http.py::test_a_redirect_to_another_host_is_not_followed",
        ),
    ),
    Breakage(
        "what students get holds the author's notebook, with its solutions",
        "exercises/authoring/publishing/public_assignment.py",
        '    yield "plays.py", assignment.plays.encode()\n',
        '    yield "plays.py", assignment.plays.encode()\n'
        '    yield "notebook.ipynb", (assignment.folder / "notebook.ipynb").read_bytes()\n',
        ("tests/exercises/authoring/publishing/test_public_assignment.py",),
    ),
    Breakage(
        "the students' notebook keeps a solution that is not a definition",
        "exercises/authoring/publishing/publish.py",
        "if SOLUTION not in cell.tags and not set(others) & set(names):",
        "if SOLUTION not in cell.tags:",
        (
            "tests/exercises/authoring/publishing/test_publish.py::test_nothing_of_a_solution_or_mistake_is_left_in_any_part_of_the_file",
        ),
    ),
    Breakage(
        "the Setup holds the author's solutions",
        "exercises/authoring/questions/author_notebook.py",
        "if cell.is_solution(names) or any(other <= level for other, _ in cell.headings):",
        "if any(other <= level for other, _ in cell.headings):",
        ("tests/exercises/authoring/questions/test_author_notebook.py",),
    ),
    Breakage(
        "polhode.check passes a play one function only",
        "exercises/kit/polhode/client/local.py",
        "play(*question, names, scene.inputs)",
        "play(*question, {scene.function: names[scene.function]}, scene.inputs)",
        ("tests/system/test_answers.py",),
    ),
    Breakage(
        "verify --write records a time-out as the expectation",
        "service/cli/authoring/verify/written_samples.py",
        "\n        or _timed_out(graded.report)\n",
        "\n",
        (
            "tests/service/cli/authoring/verify/test_command.py::test_a_time_out_is_not_written_because_a_busy_machine_can_cause_it",
        ),
    ),
    Breakage(
        "data files stay for the next submission",
        "service/sandbox/zygote.py",
        "shutil.rmtree(path) if path.is_dir() else path.unlink()",
        "pass",
        ("tests/system/test_answers.py",),
    ),
    Breakage(
        "a class without code counts as attempted",
        "exercises/kit/polhode/judging/return_value.py",
        "return all(map(is_empty, methods)) and bool(methods)",
        "return False",
        ("tests/system/test_answers.py",),
    ),
    Breakage(
        "a check of another exercise's function counts",
        "exercises/kit/polhode/judging/exercise.py",
        "if all(names_of(scene) <= present for scene in check.scenes)]",
        "if not set(self.optional) - {*written} & {name for scene in check.scenes for name in"
        " names_of(scene)}]",
        ("tests/system/test_answers.py",),
    ),
    Breakage(
        "what students get holds the drawn scenes and their truth",
        "exercises/authoring/publishing/public_assignment.py",
        "scenes = [s for s in assignment.scenes if s.name in used and not callable(s.inputs)]",
        "scenes = [s if not callable(s.inputs) else _drawn_once(s) for s in assignment.scenes if s.name in"
        " used]",
        ("tests/exercises/authoring/publishing/test_public_assignment.py",),
    ),
]
