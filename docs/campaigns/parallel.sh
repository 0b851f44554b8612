#!/usr/bin/env bash
# A campaign by GNU parallel, on this machine or on those of a login file; one shard a job.
#
#   docs/campaigns/parallel.sh SCENARIO.toml RUNS SHARDS OUT [ARGUMENTS OF parallel...]
#   docs/campaigns/parallel.sh my.toml 10000 32 /shared/my-campaign --sshloginfile nodes
#
# An interrupted campaign goes on when the same command is given again.
set -euo pipefail
if [ $# -lt 4 ]; then
  echo "usage: parallel.sh SCENARIO.toml RUNS SHARDS OUT [ARGUMENTS OF parallel...]" >&2
  exit 2
fi
scenario=$1 runs=$2 shards=$3 out=$4
shift 4
mkdir -p "$out"
parallel --will-cite --halt soon,fail=1 --joblog "$out/parallel.log" "$@" \
  "${QUATRACK:-quatrack}" campaign "$scenario" --runs "$runs" --shard {}/"$shards" --threads 1 --out "$out" \
  ::: $(seq "$shards")
"${QUATRACK:-quatrack}" campaign merge "$out"
