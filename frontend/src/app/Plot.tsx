/** A uPlot chart that follows the width of its place. */
import { useEffect, useRef } from "react";
import uPlot from "uplot";

interface Props {
  options: Omit<uPlot.Options, "width" | "height">;
  data: uPlot.AlignedData;
  height: number;
  label: string;
}

export function Plot({ options, data, height, label }: Props) {
  const place = useRef<HTMLDivElement>(null);
  const chart = useRef<uPlot | null>(null);
  const newest = useRef(data);
  newest.current = data;

  useEffect(() => {
    const element = place.current;
    if (!element) return undefined;
    const made = new uPlot({ ...options, width: element.clientWidth, height }, newest.current, element);
    chart.current = made;
    const observer = new ResizeObserver(() => made.setSize({ width: element.clientWidth, height }));
    observer.observe(element);
    return () => {
      observer.disconnect();
      chart.current = null;
      made.destroy();
    };
  }, [options, height]);

  useEffect(() => chart.current?.setData(data), [data]);

  return <div ref={place} role="img" aria-label={label} style={{ minHeight: height }} />;
}
