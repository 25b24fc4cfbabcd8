import { useEffect, useState } from "react";
import { useQueryClient } from "@tanstack/react-query";
import { advance, NOTHING, type History, type Job, type Told } from "./progress";

const OVER = new Set<Job["status"]>(["succeeded", "failed", "cancelled"]);

export function isOver(job: Job): boolean {
  return OVER.has(job.status);
}

/** A job as it is now, with what it told; listens to the server while it is not over. */
export function useJob(given: Job): { job: Job; history: History } {
  const queries = useQueryClient();
  const [job, setJob] = useState(given);
  const [history, setHistory] = useState<History>(NOTHING);
  const over = isOver(given);
  useEffect(() => setJob(given), [given]);
  useEffect(() => {
    if (over) return undefined;
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
      void queries.invalidateQueries({ queryKey: ["results"] });
      void queries.invalidateQueries({ queryKey: ["reports"] });
    });
    return () => events.close();
  }, [given.id, over, queries]);
  return { job, history };
}
