"""Takes away from itself what the harness needs."""

# ends: any
import resource

attempt("own limits", lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (0, 0)))
