// Numbers, units and times in the form people read.

const NAMES = {
  grasp_force_peak_N: ['Grasp force, peak', 'N'],
  grasp_force_mean_N: ['Grasp force, mean in contact', 'N'],
  grasp_force_peak_at_mm: ['Peak after', 'mm'],
  slip_onset_mm: ['Slips from', 'mm'],
  released_at_mm: ['Lets go at', 'mm'],
  held: ['Held (1 yes, 0 no)', ''],
  object_weight_N: ['Weight of the object', 'N'],
  weight_carried_N: ['Of it carried', 'N'],
  object_displacement_mm: ['Moved when let go', 'mm'],
  grasp_moment_N_mm: ['Moment against the turn', 'N mm'],
  grasp_moment_peak_N_mm: ['Moment against the turn, peak', 'N mm'],
  turned_deg: ['Turn of the object', '°'],
  displacement_mm: ['Displacement of the object', 'mm'],
  slip_share: ['Share that slips', ''],
  normal_force_N: ['Sum of the normal forces', 'N'],
  contact_pressure_max_kPa: ['Largest contact pressure', 'kPa'],
  contact_pressure_uniformity: ['Evenness of the contact pressure', ''],
  wrap_angle_deg: ['Angle wrapped around the object', '°'],
  curvature_match: ['Match of body and object in curvature', ''],
  cai_rad_per_m_kPa: ['Curvature per pressure', 'rad/(m·kPa)'],
  r_squared: ['R² of the fit', ''],
  intercept_deg: ['Intercept of the straight line', '°'],
  sensitivity_deg_per_kPa: ['Sensitivity', '°/kPa'],
  end_face_angle_deg: ['Angle of the end face', '°'],
  chord_angle_deg: ['Angle of the base-to-tip line', '°'],
  twist_angle_deg: ['Twist', '°'],
  side_bending_angle_deg: ['Sideways bending', '°'],
  turn_angle_deg: ['Bending in any plane', '°'],
  end_bending_angle_deg: ['Tilt of the end section', '°'],
  end_twist_angle_deg: ['Twist of the end section', '°'],
  reach_mm: ['Distance from base to tip', 'mm'],
  contraction_pct: ['Loss of reach', '%'],
  contact_onset_kPa: ['Chambers touch from', 'kPa'],
  max_stretch: ['Largest stretch', ''],
  max_von_mises_kPa: ['Largest von Mises stress', 'kPa'],
  max_principal_stress_kPa: ['Largest principal stress', 'kPa'],
  min_gap_mm: ['Smallest gap', 'mm'],
  max_penetration_mm: ['Largest penetration', 'mm'],
  wall_s: ['Elapsed time', 's'],
  cpu_s: ['Processor time', 's'],
  peak_memory_MB: ['Peak memory', 'MB'],
};

// What people look for first; everything else follows in the order of the alphabet.
const FIRST = ['grasp_force_peak_N', 'grasp_force_mean_N', 'blocked_force_N', 'bending_angle_deg',
  'sensitivity_deg_per_kPa', 'r_squared', 'intercept_deg', 'cai_rad_per_m_kPa', 'tip_deflection_mm', 'end_face_angle_deg', 'chord_angle_deg',
  'contact_onset_kPa', 'max_stretch', 'min_gap_mm', 'max_penetration_mm', 'cavity_volume_mm3',
  'mass_g'];

// Longest endings first: the first that fits is the unit.
const UNITS = [
  ['_deg_per_kPa', '°/kPa'], ['_m_s', 'm/s'], ['_mm3', 'mm³'], ['_mm2', 'mm²'], ['_N_mm', 'N mm'], ['_MPa', 'MPa'],
  ['_kPa', 'kPa'], ['_deg', '°'], ['_pct', '%'], ['_mm', 'mm'], ['_mJ', 'mJ'], ['_Pa', 'Pa'], ['_MB', 'MB'], ['_ms', 'ms'], ['_N', 'N'],
  ['_g', 'g'], ['_s', 's'], ['_m', 'm'],
];

function sentence(key) {
  const words = key.replaceAll('_', ' ');
  return words.charAt(0).toUpperCase() + words.slice(1);
}

// { label, unit } of a key such as "bending_angle_deg".
export function quantity(key) {
  if (Object.hasOwn(NAMES, key)) {
    const [label, unit] = NAMES[key];
    return { label, unit };
  }
  if (key.endsWith('_error')) {
    const base = quantity(key.slice(0, -'_error'.length));
    return { label: `${base.label}: estimated error`, unit: base.unit };
  }
  const found = UNITS.find(([ending]) => key.endsWith(ending));
  return found
    ? { label: sentence(key.slice(0, -found[0].length)), unit: found[1] }
    : { label: sentence(key), unit: '' };
}

function rank(key) {
  const place = FIRST.indexOf(key);
  return place < 0 ? FIRST.length : place;
}

// Compares two metrics by their keys, for sorting.
export function byImportance(a, b) {
  return rank(a) - rank(b) || (a < b ? -1 : Number(a > b));
}

// Narrow spaces between thousands, from five digits on.
function grouped(text) {
  const [whole, rest] = text.split('.');
  const spaced = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, '\u202f') : whole;
  return rest === undefined ? spaced : `${spaced}.${rest}`;
}

// 7.085·10⁻⁵
function scientific(size) {
  const [digits, exponent] = size.toExponential(3).split('e');
  const raised = [...exponent.replace('+', '')].map((c) => (c === '-' ? '⁻' : '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(c)]));
  return `${digits}·10${raised.join('')}`;
}

// Four significant digits; whole numbers in full.
export function number(value) {
  if (typeof value !== 'number' || !Number.isFinite(value)) {
    return '–';
  }
  if (Number.isInteger(value) && Math.abs(value) < 1e12) {
    return (value < 0 ? '−' : '') + grouped(String(Math.abs(value)));
  }
  const size = Math.abs(value);
  const text = size >= 1e7 || size < 1e-4
    ? scientific(size)
    : grouped(size.toFixed(Math.max(0, 3 - Math.floor(Math.log10(size)))));
  return (value < 0 ? '−' : '') + text;
}

export function stateWord(state) {
  return String(state).replaceAll('_', ' ');
}
