import type { FormEvent } from "react";

/** Handler of a form that does something on this page instead of loading another one. */
export function submitting(run: () => void): (event: FormEvent) => void {
  return (event) => {
    event.preventDefault();
    run();
  };
}
