#!/usr/bin/env bash
# acquire.sbatch on a real cluster: a task killed midway is submitted again, and the dataset has the bytes of one run.
#
#   check.sh WEFT SBATCH_SCRIPT
set -euo pipefail

weft=$1 script=$2
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
# shellcheck source=tests/slurm/cluster.sh
source "$here/cluster.sh"

PATH=$PATH:/usr/sbin  # where the daemons are
skip() { echo "skipped: $*"; exit 0; }
for program in munged slurmctld slurmd sbatch setpriv; do
  command -v "$program" >/dev/null || skip "there is no $program (Debian: slurm-wlm, munge)"
done
[[ $(id -u) == 0 ]] || skip "slurmd runs jobs of others, and so needs root"

work=$(mktemp -d "${TMPDIR:-/tmp}/weft_slurm_XXXXXX")
finish() {
  local code=$?
  trap - EXIT
  if ((code)); then
    echo "failed; the jobs' output and the end of the logs:"
    tail -n 20 "$work"/*.out "$work"/cluster/jobcomp.txt "$work"/cluster/log/*.out 2>/dev/null || true
  fi
  stop_cluster
  rm -rf "$work"
  exit "$code"
}
trap finish EXIT
trap 'exit 1' INT TERM

fail() { echo "$*"; exit 1; }

# Files instead of a pipe: what writes into `grep -q` is killed by SIGPIPE when it has not written all by the first match.
says() { grep -q -- "$1" "${@:2}"; }  # PATTERN FILE...

# Number of the process of ours that traces shard $1 of $work/$2; nothing where there is none.
process_of() {
  local folder command
  for folder in /proc/[0-9]*; do
    command=$(tr '\0' ' ' 2>/dev/null <"$folder/cmdline") || continue
    [[ $command != *"$weft acquire"*"$work/$2 "*"--shard $1 "* ]] || echo "${folder#/proc/}"
  done
}

views_of() {  # SHARD COUNT FOLDER: those of its views that are there
  local view name
  for view in "$3"/view_*.exr; do
    [[ -e $view ]] || continue
    name=${view##*/view_}
    ((10#${name%.exr} % $2 != $1)) || echo "$view"
  done
}

has_a_view() { [[ -n $(views_of "$@") ]]; }  # as views_of

# Everything but the records of runs, which stand outside the checksums.
same_dataset() { diff -r --exclude='run*.json' "$1" "$2"; }

cd "$work"
printf 'type = "checker"\nresolution = 64\n' >checker.toml
# Some seconds for a shard: long enough to kill it midway.
settings=(--texels 32 --directions ubo81 --spp 48 --max-bounces 4)
"$weft" acquire checker.toml -o "$work/whole.btf" "${settings[@]}" --quiet

start_cluster "$work/cluster" 3 || skip "Slurm's daemons do not come up here: $(tail -qn 1 "$work"/cluster/log/*.out)"
export WEFT=$weft

echo "== a task killed midway"
"$script" --shards 3 --tries 2 -- checker.toml -o "$work/slurm.btf" "${settings[@]}" --threads 1
wait_until 60 has_a_view 1 3 slurm.btf
victim=$(process_of 1/3 slurm.btf)
[[ $victim =~ ^[0-9]+$ ]] || fail "no process traces shard 1/3; found \"$victim\""
kill -STOP "$victim"
kept=$(views_of 1 3 slurm.btf)
(($(wc -l <<<"$kept") < 27)) || fail "shard 1/3 was done before it could be killed"
# Inode and time of writing: a view that is written again has others.
# shellcheck disable=SC2086  # one word a file
before=$(stat -c '%n %i %y' $kept)
kill -KILL "$victim"
wait_until 120 no_jobs
[[ -e slurm.btf/btf.json ]] || fail "was not finished"
same_dataset whole.btf slurm.btf || fail "differs from the dataset of one run"
# shellcheck disable=SC2086
[[ $(stat -c '%n %i %y' $kept) == "$before" ]] || fail "finished views were written again"
says 'shards 1 of 3, .*try 2 of 2' slurm-*.out || fail "not exactly the killed shard was submitted again"
"$weft" validate slurm.btf --quiet || fail "is not valid"

echo "== submitted when there is nothing to do, and with other settings"
"$script" -- checker.toml -o slurm.btf "${settings[@]}" >again.txt
says 'is finished' again.txt || fail "does not see that all is done"
code=0
"$script" -- checker.toml -o slurm.btf "${settings[@]}" --seed 7 2>error || code=$?
[[ $code == 2 && $(<error) == *'other settings'* ]] || fail "other settings are not refused: $code, $(<error)"
no_jobs || fail "submitted what had nothing to do"

echo "== an array and its finishing step by hand; a task that Slurm itself requeues"
job=$(sbatch --parsable --array=0-1 "$script" checker.toml -o hand.btf "${settings[@]}")
wait_until 60 has_a_view 0 2 hand.btf
scontrol requeue "${job}_0"
sbatch --dependency="afterany:$job" "$script" checker.toml -o hand.btf "${settings[@]}" --finish
wait_until 120 no_jobs
same_dataset whole.btf hand.btf || fail "differs from the dataset of one run"

echo "== a shard that always dies is given up"
printf '#!/usr/bin/env bash\n[[ $* != *"--shard 1/2"* ]] || kill -KILL $$\nexec "%s" "$@"\n' "$weft" >mortal
chmod +x mortal
rm -f slurm-*.out
WEFT=$work/mortal "$script" --shards=2 --tries=2 -- checker.toml -o lost.btf --texels 4 --directions regular:2x3 --spp 1
wait_until 120 no_jobs
[[ ! -e lost.btf/btf.json ]] || fail "was finished without shard 1"
says 'shards 1 of 2 are still missing views after 2 tries' slurm-*.out || fail "does not say which shard is lost"
count() { echo $#; }
[[ $(count slurm-*_1.out) == 2 ]] || fail "the lost shard was not tried twice"
[[ $(count slurm-*_0.out) == 1 ]] || fail "the whole shard was tried again"
echo "== a finishing step that is killed is taken up"
cat >mortal <<MORTAL
#!/usr/bin/env bash
# In a job of Slurm's the first to finish kills its process group: itself and the batch script.
if [[ -n \${SLURM_JOB_ID-} && \$* == *--finish* ]] && mkdir "$work/killed" 2>/dev/null; then kill -KILL 0; fi
exec "$weft" "\$@"
MORTAL
rm -f slurm-*.out
WEFT=$work/mortal "$script" --shards=2 -- checker.toml -o taken.btf --texels 4 --directions regular:2x3 --spp 1
wait_until 120 no_jobs
[[ -d killed ]] || fail "no finishing step was killed"
[[ -e taken.btf/btf.json ]] || fail "was not finished by another step"
! says 'try 2 of' slurm-*.out || fail "shards were submitted again that lacked nothing"
echo "passed in $SECONDS s"
