/** Which lines of the audit log are wanted; an empty text wants all. */
export interface Wanted {
  user_id: string;
  patient_id: string;
  action: string;
  kind: string;
  /** First day, such as 2026-11-20. */
  from: string;
  /** Last day. */
  to: string;
}

export const EVERYTHING: Wanted = { user_id: "", patient_id: "", action: "", kind: "", from: "", to: "" };

/** The same as the server is asked; days are those of the reader's clock. */
export function auditQuery({ from, to, ...words }: Wanted): Record<string, string> {
  const known = Object.entries(words).filter(([, value]) => value !== "");
  const start = (day: string, later: number) => {
    const midnight = new Date(`${day}T00:00`);
    midnight.setDate(midnight.getDate() + later);
    return midnight.toISOString();
  };
  return {
    ...Object.fromEntries(known),
    ...(from && { after: start(from, 0) }),
    ...(to && { before: start(to, 1) }),
  };
}
