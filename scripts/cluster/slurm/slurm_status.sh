#!/usr/bin/env bash
# slurm_status.sh JOB: tells Snakemake "running", "success" or "failed". Asks the controller, because not every
# cluster keeps accounts. A job that the controller has forgotten has failed: Snakemake knows by a file of its
# own when one succeeded, and a cell that is there is not computed again.
set -uo pipefail
job=$1
for _ in 1 2 3; do
  if state=$(scontrol --oneliner show job "$job" 2>&1); then
    case $state in
      *JobState=COMPLETED*) echo success ;;
      *JobState=PENDING* | *JobState=RUNNING* | *JobState=CONFIGURING* | *JobState=COMPLETING* | \
        *JobState=SUSPENDED* | *JobState=REQUEUED*) echo running ;;
      *) echo failed ;;
    esac
    exit 0
  fi
  case $state in *"Invalid job id"*) echo failed; exit 0 ;; esac
  sleep 1
done
echo running # the controller does not answer
