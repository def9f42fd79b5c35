"""Prometheus metrics: requests of this process, and the queue, results, runs and workers from the database.

Counts of results come from the database, so every server reports the same numbers and a restart does not
reset them.
"""

from collections.abc import Iterable, Sequence

from prometheus_client import CollectorRegistry, Counter, Histogram, disable_created_metrics, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily, Metric

from service.store.database import Database

disable_created_metrics()  # type: ignore[no-untyped-call]
PROCESS = CollectorRegistry()
REQUESTS = Counter(
    "polhode_http_requests", "Requests answered.", ["method", "route", "status"], registry=PROCESS
)
SECONDS = Histogram("polhode_http_seconds", "Time to answer.", ["route"], registry=PROCESS)
BUCKETS = (0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300, 900, 3600)

_DEPTH = "SELECT status::text, task_name, count(*) AS n FROM procrastinate_jobs GROUP BY 1, 2"
_RESULTS = """
SELECT count(*) FILTER (WHERE fault IS NULL) AS graded,
    count(*) FILTER (WHERE fault IS NOT NULL AND cancelled_by IS NULL) AS faulted,
      count(cancelled_by) AS cancelled FROM result
"""
_VERDICTS = (
    "SELECT count(*) FILTER (WHERE state = 'pass') AS passed, count(*) AS counted FROM outcome WHERE counted"
)
_RUNS = "SELECT end_reason, count(*) AS n FROM run WHERE end_reason IS NOT NULL GROUP BY 1"
_WORKERS = """
SELECT count(*) FILTER (WHERE seen AND unavailable_reason IS NULL) AS ready,
    count(*) FILTER (WHERE seen AND unavailable_reason IS NOT NULL) AS refusing,
    coalesce(sum(zygote_restarts), 0) AS zygotes FROM worker, LATERAL (
    SELECT seen_at BETWEEN now() - interval '10 s' AND now() + interval '10 s') AS recent (seen)
"""
_WAITS = """
SELECT extract(epoch FROM first.at - a.requested_at) AS s
FROM grading a JOIN LATERAL (SELECT min(started_at) AS at FROM run
  WHERE run.grading_id = a.id) first ON first.at IS NOT NULL
"""
_HISTOGRAM = "SELECT {} , count(*), coalesce(sum(s), 0) FROM ({}) AS measured"


async def exposition(database: Database) -> bytes:
    """Return all metrics in Prometheus's text format."""
    registry = CollectorRegistry()
    registry.register(_StaticCollector(await _from_tables(database)))
    return generate_latest(PROCESS) + generate_latest(registry)


class _StaticCollector:
    """A collector of metrics that have already been read."""

    def __init__(self, metrics: Sequence[Metric]) -> None:
        self._metrics = metrics

    def collect(self) -> Iterable[Metric]:
        return self._metrics


async def _from_tables(database: Database) -> Sequence[Metric]:
    jobs = GaugeMetricFamily(
        "polhode_queue_jobs",
        "Jobs by task and status: waiting (todo) or running (doing).",
        labels=["task", "status"],
    )
    for row in await database.rows(_DEPTH):
        jobs.add_metric([row.task_name, row.status], row.n)
    (sums,), (made,) = await database.rows(_RESULTS), await database.rows(_VERDICTS)
    results = CounterMetricFamily("polhode_results", "Results by status.", labels=["status"])
    verdicts = CounterMetricFamily("polhode_verdicts", "Counted checks by verdict.", labels=["verdict"])
    for family, name, value in (
        (results, "graded", sums.graded),
        (results, "faulted", sums.faulted),
        (results, "cancelled", sums.cancelled),
        (verdicts, "pass", made.passed),
        (verdicts, "other", made.counted - made.passed),
    ):
        family.add_metric([name], value)
    runs = GaugeMetricFamily(
        "polhode_runs", "Runs by end reason; a lost run may still report a result.", labels=["ending"]
    )
    for row in await database.rows(_RUNS):
        runs.add_metric([row.end_reason], row.n)
    (counts,) = await database.rows(_WORKERS)
    workers = GaugeMetricFamily("polhode_workers", "Workers seen in the last ten seconds.", labels=["state"])
    workers.add_metric(["ready"], counts.ready)
    workers.add_metric(["refusing"], counts.refusing)
    zygotes = GaugeMetricFamily(
        "polhode_zygote_restarts",
        "Warm guest processes replaced, summed over known workers.",
        value=counts.zygotes,
    )
    wait = await _histogram(
        database, "polhode_wait_seconds", "Time from request to the start of the first run.", _WAITS
    )
    took = await _histogram(
        database,
        "polhode_grading_seconds",
        "Time to grade.",
        "SELECT grading_s AS s FROM result WHERE grading_s IS NOT NULL",
    )
    return [jobs, results, verdicts, runs, workers, zygotes, wait, took]


async def _histogram(database: Database, name: str, help: str, query: str) -> Metric:
    counts = ", ".join(f"count(*) FILTER (WHERE s <= {edge}) AS bucket_{k}" for k, edge in enumerate(BUCKETS))
    row = await database.one(_HISTOGRAM.format(counts, query))
    buckets = [(str(float(edge)), row[k]) for k, edge in enumerate(BUCKETS)] + [("+Inf", row[len(BUCKETS)])]
    return HistogramMetricFamily(name, help, buckets=buckets, sum_value=float(row[len(BUCKETS) + 1]))
