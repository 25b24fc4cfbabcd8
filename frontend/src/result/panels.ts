/** Layout of the curves: the fixed scales and directions of the printed report. */
export interface PanelLayout {
  name: string;
  scale: readonly [number, number];
  /** What down and up mean: keys of words that begin with way_, or nothing. */
  directions: readonly [string, string];
  unit: string;
}

function panel(name: string, low: number, high: number, down: string, up: string, unit = "deg"): PanelLayout {
  return { name, scale: [low, high], directions: [down, up], unit };
}

/** Rows proximal to distal; columns sagittal, frontal, transverse. null: an empty place. */
export const KINEMATICS: readonly (PanelLayout | null)[] = [
  panel("pelvis_tilt", -20, 40, "posterior", "anterior"),
  panel("pelvis_obliquity", -30, 30, "down", "up"),
  panel("pelvis_rotation", -40, 40, "external", "internal"),
  panel("hip_flexion", -30, 70, "extension", "flexion"),
  panel("hip_adduction", -30, 30, "abduction", "adduction"),
  panel("hip_rotation", -40, 40, "external", "internal"),
  panel("knee_flexion", -20, 80, "extension", "flexion"),
  null,
  null,
  panel("ankle_dorsiflexion", -50, 40, "plantar", "dorsal"),
  null,
  panel("foot_progression", -50, 40, "external", "internal"),
];

/** Columns hip, knee, ankle; rows moments, powers, ground reactions. */
export const KINETICS: readonly PanelLayout[] = [
  panel("hip_extensor_moment", -2, 2, "flexion", "extension", "N·m/kg"),
  panel("knee_extensor_moment", -1.5, 2, "flexion", "extension", "N·m/kg"),
  panel("ankle_plantarflexor_moment", -1, 2.5, "dorsal", "plantar", "N·m/kg"),
  panel("hip_power", -3, 4, "absorbed", "generated", "W/kg"),
  panel("knee_power", -4, 3, "absorbed", "generated", "W/kg"),
  panel("ankle_power", -3, 6, "absorbed", "generated", "W/kg"),
  panel("ground_reaction_vertical", 0, 150, "", "up", "%BW"),
  panel("ground_reaction_forward", -40, 40, "backward", "forward", "%BW"),
  panel("ground_reaction_medial", -20, 20, "lateral", "medial", "%BW"),
];
