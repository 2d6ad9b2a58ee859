#!/bin/bash
# The short form of `make reliability-events`.
exec bash "$(dirname "$0")/../reliability/subscribers.sh" 200 4
