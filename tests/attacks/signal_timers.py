"""Timers of the kernel, in memory and CPU time."""

# ends: pass
import signal

attempt("timer_create", lambda: raw(222, 0, 0, 0))
attempt("timerfd_create", lambda: raw(283, 1, 0))
attempt("virtual timer", lambda: signal.setitimer(signal.ITIMER_VIRTUAL, 1, 1))
attempt("eventfd", lambda: raw(290, 0, 0))
attempt("signalfd", lambda: raw(289, -1, 0, 8, 0))
