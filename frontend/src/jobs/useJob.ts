import { useEffect, useState } from "react";
import { useQueryClient } from "@tanstack/react-query";
import { advance, NOTHING, type History, type Job, type Told } from "./progress";

const OVER = new Set<Job["status"]>(["succeeded", "failed", "cancelled"]);
/** Pages ask again so often while a job of theirs is not over. */
export const LOOK_AGAIN_MS = 2_000;
/**
 * Streams of one page. A browser opens six connections to a server, for all its pages together: with one for each job
 * of a long queue nothing else would come through, not even the next page.
 */
const MOST_STREAMS = 2;
let streams = 0;

export function isOver(job: Job): boolean {
  return OVER.has(job.status);
}

/** A job as it is now, with what it told: a running one is listened to, others are as new as `given`. */
export function useJob(given: Job): { job: Job; history: History } {
  const queries = useQueryClient();
  const [job, setJob] = useState(given);
  const [history, setHistory] = useState<History>(NOTHING);
  const running = given.status === "running";
  useEffect(() => setJob(given), [given]);
  useEffect(() => {
    if (!running || streams >= MOST_STREAMS) return undefined;
    streams += 1;
    const events = new EventSource(`/api/v1/analyses/${given.id}/events`);
    events.addEventListener("progress", (event: MessageEvent<string>) => {
      const told = JSON.parse(event.data) as Told;
      setHistory((before) => advance(before, told));
    });
    events.addEventListener("job", (event: MessageEvent<string>) => {
      const told = JSON.parse(event.data) as Job;
      setJob(told);
      if (!isOver(told)) return;
      events.close();
      void queries.invalidateQueries({ queryKey: ["jobs"] });
    });
    return () => {
      streams -= 1;
      events.close();
    };
  }, [given.id, running, queries]);
  const over = isOver(job);
  useEffect(() => {
    if (!over) return;
    void queries.invalidateQueries({ queryKey: ["results"] });
    void queries.invalidateQueries({ queryKey: ["reports"] });
  }, [over, queries]);
  return { job, history: history === NOTHING ? advance(NOTHING, job.progress) : history };
}
