-- wrk: submits the job in the file that the environment names, and counts what was not accepted.
local file = assert(io.open(os.getenv("POST_DOCUMENT"), "rb"))
wrk.method = "POST"
wrk.headers["Content-Type"] = "application/json"
wrk.body = file:read("*a")
file:close()
