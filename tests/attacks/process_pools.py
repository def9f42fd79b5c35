"""Pools of processes and threads."""

# ends: pass
import concurrent.futures
import multiprocessing

attempt("pool", lambda: multiprocessing.get_context("fork").Pool(4))
attempt("threads", lambda: concurrent.futures.ThreadPoolExecutor(4).submit(abs, 1).result())
