/** The parts of result.json that the pages show; docs/result.md explains them. Fields with a default may be absent. */
export const SIDES = ["left", "right"] as const;
export type Side = (typeof SIDES)[number];
export type Values = readonly (number | null)[];

export interface Curve {
  mean: Values;
  sd: Values;
  n_cycles: number;
}

export interface CurveSides {
  unit?: string;
  left: Curve | null;
  right: Curve | null;
}

export interface Band {
  mean: Values;
  sd: Values;
}

export interface Reference {
  description: string;
  curves: Record<string, Band>;
  kinetics?: Record<string, Band>;
  emg?: Record<string, Band>;
  spatiotemporal?: Record<string, { mean: number; sd: number }>;
  gvs?: Record<string, { mean: number; sd: number }>;
  gps?: { mean: number; sd: number } | null;
  weights?: Record<string, { mean: number; sd: number }>;
}

export interface SideScores {
  gvs: Record<string, number>;
  gps: number | null;
  gdi: number | null;
  n_cycles: number;
}

export interface Criterion {
  name: string;
  weight: number;
  sd: number | null;
  identifiable: boolean;
  at_bound?: boolean;
  cost_share?: number | null;
  /** Where the weight lies with 95 % confidence. */
  interval_95?: readonly [number, number] | null;
}

export interface Weights {
  criteria: Criterion[];
  fit: { rms_rad: number; per_joint: Record<string, number>; unseen_stride_rms_rad?: Record<string, number> };
  solver: { status: string; kkt_residual: number | null; iterations: number; seconds: number; message?: string };
  comparison?: {
    equal_weights_rms_rad: number | null;
    single_criterion_rms_rad: Record<string, number | null>;
  } | null;
  pooled?: {
    n_strides: number;
    weights: Record<string, number>;
    between_stride_sd: Record<string, number | null>;
  } | null;
  strides?: Stride[];
  /** Pairs of criteria of which one could take over the other's weight. */
  not_told_apart?: [string, string][];
  notes?: string[];
}

export interface Stride {
  trial: string;
  side: Side;
  start_s: number;
  end_s: number;
  outlier?: string[];
  representative?: boolean;
}

export interface SideSpatiotemporal {
  n_cycles: number;
  mean: Record<string, number | null>;
  sd: Record<string, number | null>;
}

export interface ResultDocument {
  version: string;
  events: { side: Side; kind: string; time_s: number; trial: string }[];
  inputs: { name: string; role: string }[];
  spatiotemporal: { left: SideSpatiotemporal | null; right: SideSpatiotemporal | null };
  kinematics: Record<string, CurveSides>;
  kinetics?: { curves: Record<string, CurveSides>; moments_in: string; missing: string[] } | null;
  emg?: { envelopes: Record<string, CurveSides>; filter: string; muscles: Record<string, string> } | null;
  weights: Weights | null;
  strides?: { strides: Stride[]; rule: string } | null;
  scores?: {
    reference: Reference | null;
    left: SideScores | null;
    right: SideScores | null;
    gps_overall: number | null;
    missing?: string[];
  } | null;
  prediction?: {
    source: string;
    request: Record<string, number>;
    units: Record<string, string>;
    status: string;
    message: string;
    identified: Record<string, number>;
    predicted: Record<string, number>;
    assumptions: string[];
  } | null;
  warnings: string[];
}
