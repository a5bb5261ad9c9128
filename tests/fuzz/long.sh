#!/usr/bin/env bash
# Fuzzes for long, going on from what earlier runs found interesting: tests/fuzz/long.sh [SECONDS [TARGET]...], 600 s a
# target.
exec "$(dirname "$0")/../run.sh" --stage fuzz "${@:-600}"
